// Looking around with a mouse, with fingers, and by keys; and pointing at sections.

/** Let a stage be turned, moved and zoomed; `point` hears of the section under the pointer, `pin` of one that is pressed. */
function listenTo(stage, { point, pin }) {
  const { paper } = stage;
  const { canvas } = paper;
  const pointers = new Map();
  let moved = 0;

  const at = (event) => {
    const frame = canvas.getBoundingClientRect();
    return [event.clientX - frame.left, event.clientY - frame.top];
  };

  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, at(event));
    moved = 0;
    if (pointers.size === 1 && event.button === 0) live.drag?.start(at(event));
  });

  canvas.addEventListener("pointermove", (event) => {
    const now = at(event);
    const before = pointers.get(event.pointerId);
    if (live.drag?.moving) {
      live.drag.move(now);
      return;
    }
    if (!before) {
      live.drag?.seek(now);
      point(sectionUnder(paper, stage.instant, ...now), event);
      return;
    }
    const [dx, dy] = [now[0] - before[0], now[1] - before[1]];
    moved += Math.abs(dx) + Math.abs(dy);
    if (pointers.size === 2) {
      const other = [...pointers.entries()].find(([id]) => id !== event.pointerId)[1];
      const spread = (one) => Math.hypot(one[0] - other[0], one[1] - other[1]);
      stage.pan(dx / 2, dy / 2);
      stage.zoom(spread(now) / (spread(before) || 1), [(now[0] + other[0]) / 2, (now[1] + other[1]) / 2]);
    } else if (!contents.space || event.shiftKey || event.buttons > 1) stage.pan(dx, dy);
    else stage.orbit(dx, dy);
    pointers.set(event.pointerId, now);
  });

  const leave = (event) => {
    const dragged = live.drag?.moving;
    live.drag?.end();
    if (!dragged && pointers.has(event.pointerId) && event.type === "pointerup" && moved < 5) {
      const found = sectionUnder(paper, stage.instant, ...at(event));
      if (found) pin(found);
    }
    pointers.delete(event.pointerId);
  };
  for (const kind of ["pointerup", "pointercancel"]) canvas.addEventListener(kind, leave);
  canvas.addEventListener("pointerleave", () => point(null));
  canvas.addEventListener("dblclick", () => stage.fit());
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener(
    "wheel",
    (event) => {
      // The page goes on scrolling over a picture in which nobody is at work.
      if (!event.ctrlKey && document.activeElement !== canvas) return;
      event.preventDefault();
      stage.zoom(Math.exp(-0.0015 * event.deltaY * (event.deltaMode ? 30 : 1)), at(event));
    },
    { passive: false },
  );
  canvas.addEventListener("keydown", (event) => {
    const move = (x, y) => (contents.space ? stage.orbit(20 * x, 20 * y) : stage.pan(30 * x, 30 * y));
    const keys = {
      "+": () => stage.zoom(1.2),
      "=": () => stage.zoom(1.2),
      "-": () => stage.zoom(1 / 1.2),
      ArrowLeft: () => event.altKey && move(1, 0),
      ArrowRight: () => event.altKey && move(-1, 0),
      ArrowUp: () => move(0, 1),
      ArrowDown: () => move(0, -1),
      Escape: () => {
        const undone = live.drag?.undo() ?? false;
        if (undone) pointers.clear();
        return undone;
      },
    };
    if (keys[event.key] && keys[event.key]() !== false) event.preventDefault();
  });
}
