"""Comments of XML: two hyphens in them are refused by their line, in time that grows with the length of the document."""

from __future__ import annotations

import pytest

import ulna
from ulna.errors import FormatError
from ulna.formats.comments import comments, line_of_double_hyphen, without_comments

ROBOT = "<robot name='arm'>\n{}\n<link name='base'/></robot>"


@pytest.mark.parametrize(
    "comment", ["<!-- a -- b -->", "<!-- a --->", "<!--\n--a-->", "<!-- a <!-- b -->", "<!-- -- "]
)
def test_two_hyphens_are_refused_with_their_line(comment: str) -> None:
    line = 2 + comment[: comment.rindex("--", 0, -2)].count("\n")
    for encoding in ("utf-8", "utf-16", "utf-16-le", "utf-32"):
        assert line_of_double_hyphen(ROBOT.format(comment).encode(encoding)) == line
    with pytest.raises(
        FormatError, match=rf":{line}: .*two hyphens \(--\)\. Between <!-- and --> write other signs"
    ):
        ulna.load(ROBOT.format(comment))


@pytest.mark.parametrize(
    "comment", ["<!-- a - b -->", "<!---->", "<!--\n a\n-->", "<!-- a --><!-- b -->", "<?note -- ?>"]
)
def test_other_comments_are_read(comment: str) -> None:
    assert line_of_double_hyphen(ROBOT.format(comment).encode()) == 0
    assert ulna.load(ROBOT.format(comment)).model.links[0].name == "base"


def test_what_looks_like_a_comment_in_character_data_is_none() -> None:
    text = ROBOT.format("<![CDATA[<!-- a -- b]]>").encode()
    assert list(comments(text)) == [] and line_of_double_hyphen(text) == 0


def test_comments_are_left_out_and_lines_stay() -> None:
    text = b"<a>\n<!-- 1\n2 -- --><b/>\n<![CDATA[<!--]]><!-- open\n<c/>"
    assert without_comments(text) == b"<a>\n\n<b/>\n<![CDATA[<!--]]>\n"
