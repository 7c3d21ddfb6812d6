// Runs before viser's program, written for viser 1.1: installs the hook before any message arrives, and lets a tab whose
// program ended try to reconnect four times a second, without interrupting an attempt that is under way. The first attempt
// waits, too: viser's would come at once, and its worker discards messages of the old connection that it holds back to
// smooth their times. The panel shows neither the address of the socket nor switches that help to develop viser.
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
  const post = Worker.prototype.postMessage, watched = new WeakSet(), nextAttempt = new WeakMap();
  const PAUSE = 250, ATTEMPT = 5000;  // ms between attempts, and that one may take
  Worker.prototype.postMessage = function (message, ...rest) {
    // viser's first message precedes its listener: this one is called before it, and so before its attempt
    if (["zstd_wasm", "set_server"].includes(message?.type) && !watched.has(this)) {
      watched.add(this);
      this.addEventListener("message", ({data}) => {
        if (data?.type === "connected") page?.ulnaPlayback?.connected();
        if (data?.type !== "closed") return;
        page?.ulnaPlayback?.closed();
        nextAttempt.set(this, performance.now() + PAUSE - 10);
        if (!data.versionMismatch && document.hasFocus()) setTimeout(() => this.postMessage({type: "retry"}), PAUSE);
      });
    }
    if (message?.type === "set_server" || message?.type === "retry") {
      const now = performance.now();
      if (message.type === "retry" && now < (nextAttempt.get(this) ?? -Infinity)) return;
      nextAttempt.set(this, now + ATTEMPT);
    }
    post.call(this, message, ...rest);
  };
})();
