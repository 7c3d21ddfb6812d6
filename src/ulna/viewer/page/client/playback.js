// What a page shows after its program has ended: the motion that it was sent, with a time line to play and scrub it.
//
// The page keeps the poses that it receives, with their times, within LIMIT bytes. At its end a program sends the whole
// motion, which replaces them; after a crash there is what was received. The next program that connects begins anew.
(() => {
  const page = window.__viserMutable;
  if (!page || page.ulnaPlayback) return;
  const LIMIT = 64e6, PATIENCE = 750, SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5];  // bytes, ms until a lost program has ended
  const LONGEST_FRAME = 250;  // ms: where frames take longer, the motion is slow instead of unseen
  let frames = [], size = 0, arriving = [], whole = false, bar = null, waiting = 0;
  const sizeOf = list => list.reduce((sum, frame) => sum + frame.p.byteLength, 0);

  const record = ({names, t, p}) => {
    if (whole || t === null || t === undefined) return;
    while (frames.length && frames[frames.length - 1].t >= t) size -= frames.pop().p.byteLength;
    frames.push({t, names, p: p.slice()});
    size += p.byteLength;
    if (size > LIMIT && frames.length > 4) {
      frames = frames.filter((_, k) => k % 2 === 0 || k === frames.length - 1);
      size = sizeOf(frames);
    }
  };

  const take = ({names, t, p, part, parts}) => {
    if (part === 0) arriving = [];
    const step = 7 * names.length, rows = p.slice();
    t.forEach((time, k) => arriving.push({t: time, names, p: rows.subarray(k * step, (k + 1) * step)}));
    if (part < parts - 1) return;
    frames = arriving;
    arriving = [];
    whole = true;
    bar?.update();
  };

  // the last frame that is not later
  const at = t => {
    let low = 0, high = frames.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (frames[middle].t <= t + 5e-4) low = middle; else high = middle - 1;
    }
    return frames[low];
  };

  // where nodes are first: there they stand before their first frame, too
  const firstPlaces = () => {
    const out = new Map();
    let known = null;
    for (const {names, p} of frames) {
      if (names === known) continue;
      known = names;
      names.forEach((name, i) => { if (!out.has(name)) out.set(name, p.subarray(7 * i, 7 * i + 7)); });
    }
    return out;
  };

  const make = (kind, attributes, ...inside) => {
    const element = Object.assign(document.createElement(kind), attributes);
    element.append(...inside);
    return element;
  };

  const STYLE = `.ulna-playback {position: fixed; left: 50%; bottom: 14px; transform: translateX(-50%); z-index: 1000;
      width: min(640px, calc(100% - 28px)); box-sizing: border-box; padding: 9px 15px 11px; border-radius: 12px;
      font: 13px/1.4 system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; color: #18212f;
      background: rgba(255, 255, 255, 0.93); box-shadow: 0 1px 2px rgba(15, 23, 42, 0.1), 0 10px 30px rgba(15, 23, 42, 0.18)}
    .ulna-playback > div {display: flex; align-items: center; gap: 11px}
    .ulna-playback p {margin: 0; color: #5d6b7e}
    .ulna-playback button {flex: none; width: 34px; height: 34px; border: 0; border-radius: 50%; cursor: pointer;
      background: #2563eb; color: white; font: 14px/1 system-ui, "DejaVu Sans", sans-serif}
    .ulna-playback input {flex: 1; min-width: 0; accent-color: #2563eb; cursor: pointer}
    .ulna-playback output {flex: none; min-width: 108px; text-align: right; font-variant-numeric: tabular-nums}
    .ulna-playback select {flex: none; font: inherit; color: inherit; background: transparent; border: 1px solid #d9e0e8;
      border-radius: 6px; padding: 2px}
    [data-mantine-color-scheme="dark"] .ulna-playback {color: #e8edf4; background: rgba(28, 34, 44, 0.94)}
    [data-mantine-color-scheme="dark"] .ulna-playback p {color: #a4b1c3}
    [data-mantine-color-scheme="dark"] .ulna-playback select {border-color: #455063; background: #1c222c}`;

  // a bar at the lower edge; what it shows begins at the end of the motion, as the program left it
  const makeBar = () => {
    const words = make("p"), button = make("button", {type: "button"});
    const slider = make("input", {type: "range", min: 0, step: 0.001, ariaLabel: "time [s]"});
    const clock = make("output"), speed = make("select", {ariaLabel: "speed"},
      ...SPEEDS.map(factor => make("option", {value: factor, textContent: `${factor} ×`, selected: factor === 1})));
    const controls = make("div", {}, button, slider, clock, speed);
    const root = make("section", {className: "ulna-playback", ariaLabel: "Motion of the program that has ended"},
      make("style", {textContent: STYLE}), words, controls);
    let begin = 0, length = 0, time = 0, playing = false, before = 0, gone = false, places = new Map();
    const showFrame = ({names, p}) => {
      const present = new Set(names), absent = [...places].filter(([name]) => !present.has(name));
      if (absent.length) page.ulnaShow?.({names: absent.map(([name]) => name), p: absent.flatMap(([, row]) => [...row])});
      page.ulnaShow?.({names, p});
    };
    const show = t => {
      time = Math.min(Math.max(t, 0), length);
      slider.value = time;
      clock.value = `${time.toFixed(2)} s of ${length.toFixed(2)} s`;
      if (frames.length > 1) showFrame(at(begin + time));
    };
    const play = now => {
      playing = now;
      button.textContent = now ? "❚❚" : "▶";
      button.ariaLabel = now ? "Pause" : "Play";
      before = performance.now();
      if (now && time > length - 2e-3) show(0);  // the slider rounds to 1e-3
      if (now) requestAnimationFrame(tick);
    };
    const tick = now => {
      if (!playing || gone) return;
      show(time + Math.min(Math.max(now - before, 0), LONGEST_FRAME) / 1000 * speed.value);
      before = Math.max(now, before);
      if (time >= length) play(false); else requestAnimationFrame(tick);
    };
    button.onclick = () => play(!playing);
    slider.oninput = () => {
      play(false);
      show(+slider.value);
    };
    const update = () => {
      const moves = frames.length > 1;
      begin = moves ? frames[0].t : 0;
      length = moves ? frames[frames.length - 1].t - begin : 0;
      slider.max = length;
      places = firstPlaces();
      words.textContent = moves ? "The program has ended. This is the motion that it made:" : "The program has ended.";
      controls.hidden = !moves;
      controls.style.display = moves ? "" : "none";
      play(false);
      show(length);
    };
    document.body.append(root);
    update();
    const again = setInterval(() => { if (!playing) show(time); }, 500);  // for what is loaded by now
    return {update, remove: () => {
      gone = true;
      clearInterval(again);
      root.remove();
    }};
  };

  const closed = () => { waiting ||= setTimeout(() => { bar ??= makeBar(); }, PATIENCE); };
  const connected = () => {
    clearTimeout(waiting);
    bar?.remove();
    [frames, size, arriving, whole, bar, waiting] = [[], 0, [], false, null, 0];
  };
  page.ulnaPlayback = {record, take, closed, connected};
})();
