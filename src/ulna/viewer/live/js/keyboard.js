// Keys: they shift and turn the selected frame, and do what the buttons do.

export const KEYS = [
  ["← → ↑ ↓", "shift the target left, right, back, forth"],
  ["Page ↑ ↓", "shift it up and down"],
  ["Alt + these", "turn it"],
  ["Shift", "with these: a tenth of the step"],
  ["N", "select the next frame"],
  ["1 … 9", "go to a named configuration"],
  ["Space", "play and pause a recorded motion"],
  ["W", "axes of the world, or of the frame"],
  ["Home", "first view"],
  ["T", "light or dark"],
  ["P", "show and hide the panel"],
  ["?", "this list"],
  ["Esc", "end a drag"],
];

const SHIFT = 0.01, TURN = (2 * Math.PI) / 180; // m and rad a key
const WAYS = {
  ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowUp: [0, 1, 0], ArrowDown: [0, -1, 0], PageUp: [0, 0, 1], PageDown: [0, 0, -1],
};

/** Answers keys of the element, with keys="page" also those of a page in which nothing has the focus; until `signal`. */
export function listen(host, canvas, act, signal) {
  const answer = (event) => {
    canvas.classList.add("keys"); // the focus is shown to those who use keys
    if (host.root.querySelector("dialog[open]")) return;
    const typing = event.composedPath()[0].matches?.("input, select, textarea");
    if (event.key === "Escape") return act.escape();
    if (typing || event.ctrlKey || event.metaKey) return;
    const way = WAYS[event.key];
    if (way && (event.composedPath()[0] === canvas || event.target === document.body)) {
      act.nudge(way, event.altKey, (event.shiftKey ? 0.1 : 1) * (event.altKey ? TURN : SHIFT));
      event.preventDefault();
      return;
    }
    const onButton = event.composedPath()[0].matches?.("button, summary, a");
    const done = command(event.key, onButton, act);
    if (done) event.preventDefault();
  };
  host.addEventListener("keydown", answer, { signal });
  if (host.getAttribute("keys") === "page")
    document.addEventListener("keydown", (event) => event.target === document.body && answer(event), { signal });
}

function command(key, onButton, act) {
  if (/^[1-9]$/.test(key)) return act.configuration(Number(key) - 1);
  if (key === " ") return !onButton && act.play();
  const commands = { n: act.next, w: act.axes, Home: act.home, t: act.theme, p: act.panel, "?": act.help };
  const run = commands[key] || commands[key.toLowerCase()];
  if (!run) return false;
  run();
  return true;
}
