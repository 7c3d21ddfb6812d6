// Runs before viser's program, written for viser 1.1: installs the hook before any message arrives, and lets a tab whose
// program ended try to reconnect four times a second, without interrupting an attempt that is under way. The panel shows
// neither the address of the socket nor switches that help to develop viser.
(() => {
  const style = document.createElement("style"), address = ".mantine-TextInput-root:has(.mantine-Image-root)";
  style.textContent = `${address}, ${address} ~ div:has(> .mantine-Checkbox-root) {display: none !important}`;
  document.documentElement.append(style);
  let page;
  Object.defineProperty(window, "__viserMutable", {configurable: true, get: () => page, set: now => {
    page = now;
    if (page) hook();
  }});
  function hook() {
    HOOK
  }
  const post = Worker.prototype.postMessage, asked = new WeakMap();
  Worker.prototype.postMessage = function (message, ...rest) {
    if (message?.type === "set_server" && !asked.has(this)) this.addEventListener("message", ({data}) => {
      if (data?.type === "connected") page?.ulnaPlayback?.connected();
      if (data?.type !== "closed") return;
      page?.ulnaPlayback?.closed();
      asked.set(this, -Infinity);
      if (!data.versionMismatch && document.hasFocus()) setTimeout(() => this.postMessage({type: "retry"}), 250);
    });
    if (message?.type === "set_server" || message?.type === "retry") {
      const now = performance.now();
      if (message.type === "retry" && now - (asked.get(this) ?? -Infinity) < 5000) return;
      asked.set(this, now);
    }
    post.call(this, message, ...rest);
  };
})();
