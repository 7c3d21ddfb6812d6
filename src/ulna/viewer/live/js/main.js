// The program of the page: it defines the element <ulna-robot>.

import { UlnaRobot } from "./element.js";

if (!customElements.get("ulna-robot")) customElements.define("ulna-robot", UlnaRobot);
const robots = customElements.get("ulna-robot");
globalThis.ulnaRobot = (name, description) => robots.define(name, description);
