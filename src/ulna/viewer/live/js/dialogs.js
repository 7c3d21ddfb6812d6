// Two dialogs: the keys, and where the robot's description, its meshes and the program come from.

import { element, iconButton } from "./dom.js";
import { KEYS } from "./keyboard.js";

export function helpDialog() {
  const rows = KEYS.map(([key, text]) => element("tr", {}, element("td", {}, element("kbd", {}, key)), element("td", {}, text)));
  return dialog("Help", [
    element("p", {}, "Drag an arrow to shift the tool, a ring to turn it, the ball to move it across the view. Elsewhere the mouse turns the camera; the right button or two fingers shift it, the wheel or a pinch zooms."),
    element("table", {}, ...rows),
  ]);
}

export function aboutDialog(credits) {
  return dialog("About", credits.flatMap(({ title, text, licence }) => [
    element("h3", {}, title),
    text ? element("p", {}, text) : null,
    licence ? element("pre", {}, licence) : null,
  ]));
}

function dialog(title, content) {
  const root = element("dialog", { class: "card", "aria-label": title });
  const close = iconButton("close", "Close", () => root.close());
  root.append(
    element("header", {}, element("div", { class: "name" }, element("h2", {}, title)), close),
    element("div", { class: "text", tabindex: "0" }, ...content.filter(Boolean)),
  );
  root.addEventListener("click", (event) => event.target === root && root.close());
  return root;
}
