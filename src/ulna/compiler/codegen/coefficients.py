"""Coefficients of the polynomials of elementary functions, and constants in parts, for double and single precision.

`scripts/fit_sincos.py` and `scripts/fit_elementary.py` derive them and, with `--check`, verify them.
"""

from __future__ import annotations

from ulna.compiler.codegen.ir_text import DType

Numbers = dict[DType, tuple[float, ...]]


def _numbers(double: str, single: str) -> Numbers:
    """Numbers in hexadecimal notation, for each format."""
    return {
        "double": tuple(map(float.fromhex, double.split())),
        "float": tuple(map(float.fromhex, single.split())),
    }


SIN = _numbers(
    "-0x1.5555555555548p-3 0x1.111111110f731p-7 -0x1.a01a019be9659p-13 0x1.71de3555b2b21p-19 "
    "-0x1.ae5e4bac4a9a6p-26 0x1.5d8b245959c14p-33",
    "-0x1.555546p-3 0x1.110778p-7 -0x1.99540ap-13",
)
"""Sine: (sin r - r) / r^3, by powers of r^2."""

COS = _numbers(
    "0x1.555555555554bp-5 -0x1.6c16c16c15015p-10 0x1.a01a019c8f256p-16 -0x1.27e4f7f1925ep-22 "
    "0x1.1ee9dbd0ca37dp-29 -0x1.8fa6861e3d552p-37",
    "0x1.55554ap-5 -0x1.6c0c28p-10 0x1.99e80ep-16",
)
"""Cosine: (cos r - 1 + r^2/2) / r^4, by powers of r^2."""

HALF_PI = _numbers(
    "0x1.921fb54442d18p+0 0x1.1a62633p-54 0x1.45c06e0e68948p-86",
    "0x1.921fb4p+0 0x1.4442d2p-24 -0x1.ee59dap-50",
)
"""pi/2 in parts. For doubles the second is short enough for its product with any k in range to be exact."""

SHORT_HALF_PI = tuple(
    map(float.fromhex, ("0x1.921fb54p+0", "0x1.10b461p-30", "0x1.a626331p-58", "0x1.1701b839a252p-88"))
)
"""pi/2 in positive parts; products of all but the last with any k in range are exact without FMA."""

TWO_OVER_PI = _numbers("0x1.45f306dc9c883p-1", "0x1.45f306p-1")
"""2/pi."""

ASIN = _numbers(
    "0x1.5555555555577p-3 0x1.333333332e131p-4 0x1.6db6db7212709p-5 0x1.f1c71a94ebe18p-6 "
    "0x1.6e8bdee16bbc6p-6 0x1.1c49f0417df64p-6 0x1.ca1f9085f32bfp-7 0x1.75856ca7a50b6p-7 "
    "0x1.613d41b37e3a2p-7 0x1.e5e9d08ad22aap-9 0x1.63a052c424301p-6 -0x1.5803783018bdcp-6 "
    "0x1.0b48cc1e1859p-5",
    "0x1.5555c8p-3 0x1.330204p-4 0x1.747bbep-5 0x1.8c3de6p-6 0x1.595cd8p-5",
)
"""Arcsine: (arcsin t - t) / t^3, by powers of t^2."""

ATAN = _numbers(
    "-0x1.5555555555516p-2 0x1.999999999113bp-3 -0x1.249249215da96p-3 0x1.c71c7090cb1dep-4 "
    "-0x1.745cf4c7393f4p-4 0x1.3b113d7249479p-4 -0x1.10f31b62c3aedp-4 0x1.dfe941e290b2ap-5 "
    "-0x1.a3978d9bc4aep-5 0x1.56f4452b8a2eap-5 -0x1.c18017df787ffp-6 0x1.4b8ef296f90ddp-7",
    "-0x1.555512p-2 0x1.997b06p-3 -0x1.2249a6p-3 0x1.9ff9cep-4 -0x1.a3cda4p-5",
)
"""Arctangent: (arctan t - t) / t^3, by powers of t^2."""

LOG = _numbers(
    "0x1.5555555555592p-1 0x1.999999997ff5dp-2 0x1.24924941dbda6p-2 0x1.c71c52198d5b6p-3 "
    "0x1.74663bbfa5488p-3 0x1.39a209273041dp-3 0x1.2f0264fab5583p-3",
    "0x1.55557ap-1 0x1.995edap-2 0x1.31dfe6p-2",
)
"""Logarithm: (log((1 + s) / (1 - s)) / s - 2) / s^2, by powers of s^2."""

EXP = _numbers(
    "0x1.55555555555p-3 0x1.55555555531c8p-5 0x1.1111111128b3cp-7 0x1.6c16c17cd961ap-10 "
    "0x1.a01a011b66889p-13 0x1.a019aae082bb9p-16 0x1.71df5658e3d46p-19 0x1.289fdd9f22f48p-22 "
    "0x1.ad1f5a74518f8p-26",
    "0x1.5554a2p-3 0x1.555688p-5 0x1.123004p-7 0x1.6b6e1cp-10",
)
"""Exponential: (e^r - 1 - r - r^2/2) / r^3."""

EXPM1 = _numbers(
    "0x1.5555555555559p-3 0x1.5555555555548p-5 0x1.111111110f7bbp-7 0x1.6c16c16c1cdb3p-10 "
    "0x1.a01a01af8c59fp-13 0x1.a01a0182d5b27p-16 0x1.71ddf9138f8b8p-19 0x1.27e52b66628e3p-22 "
    "0x1.af5d9b74779dcp-26 0x1.1ef5177ce61bfp-29",
    "0x1.555554p-3 0x1.5554f2p-5 0x1.1111ccp-7 0x1.6d40fep-10 0x1.9fbdap-13",
)
"""The same, by its error relative to the exponential less 1."""

ERF = _numbers(
    "0x1.06eba8214db69p-3 -0x1.812746b0379d1p-2 0x1.ce2f21a04131p-4 -0x1.b82ce311eb8cbp-6 "
    "0x1.565bccef8dcd7p-8 -0x1.c02dad05526d8p-11 0x1.f9a22c51cbc7dp-14 -0x1.f4bbcd0764cc3p-17 "
    "0x1.b897e2b9eafbdp-20 -0x1.534830e48a3b4p-23 0x1.79717e1dc7466p-27",
    "0x1.06eba8p-3 -0x1.812732p-2 0x1.ce284p-4 -0x1.b76ccp-6 0x1.4d16fep-8 -0x1.5552e6p-11",
)
"""Error function: erf(x) / x - 1, by powers of x^2."""

ERFC = _numbers(
    "0x1.29ea4d0a0b238p+1 0x1.a28c7a684a093p-1 0x1.980e77974874fp-5 -0x1.895d7ef6b4139p-7 "
    "0x1.222d17df0620ep-9 -0x1.65210fcac6bd8p-13 -0x1.52951db447966p-14 0x1.865936e145b45p-15 "
    "-0x1.bfebb879b629ap-17 0x1.eb8b7bdd627b7p-20 0x1.9877668a4e993p-22 -0x1.70aa0838f5374p-22 "
    "0x1.112769a6a5d5bp-23 -0x1.0f04139094c44p-25 0x1.7c0f7286978fcp-28 -0x1.6c4c753bc5d4ep-31 "
    "0x1.ad8cea138b995p-35 -0x1.d5d018995fb23p-40",
    "0x1.29ea4ep+1 0x1.a28c4ap-1 0x1.9828c2p-5 -0x1.8b013ep-7 0x1.3034fep-9 -0x1.3dcacep-12 0x1.3fa5cep-16",
)
"""Its complement: (log(erfc(b)) - log(erfc(b + u))) / u, b = 13/16, by powers of u."""

ERFC_EXPONENT = _numbers("0x1.6257d5cdb7088p+0 0x1.29c56adf13e2p-55", "0x1.6257d6p+0 -0x1.9247bcp-27")
"""-log(erfc(13/16)) in parts."""

LN2 = _numbers("0x1.62e42fefa4p-1 -0x1.8432a1b0e2634p-43", "0x1.62ep-1 0x1.0bfbe8p-15")
"""log 2 in parts; the first has free bits for the exponent, so that its product with it is exact."""

LOG2E = _numbers("0x1.71547652b82fep+0", "0x1.715476p+0")
"""1 / log 2."""

QUARTER_PI = _numbers("0x1.921fb54442d18p-1 0x1.1a62633145c07p-55", "0x1.921fb8p-1 -0x1.5dde98p-24")
"""pi/4 in parts, the first exact when multiplied by 1, 2, 3 or 4."""
