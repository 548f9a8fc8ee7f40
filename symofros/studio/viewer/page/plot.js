// A plot over time beside the picture: a line stands at the time that is shown, and a click moves that.
// Views and replays say how they tell the time and how it is moved.
window.plotOverTime = (root, { t, name, curves }, time, seek) => {
  const colors = ["#1f77b4", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7a5195", "#8c564b"];
  const canvas = document.createElement("canvas"), legend = document.createElement("ul");
  const low = Math.min(...curves.map(({ values }) => values.reduce((a, b) => Math.min(a, b), Infinity)));
  const high = Math.max(...curves.map(({ values }) => values.reduce((a, b) => Math.max(a, b), -Infinity)));
  const margin = 0.05 * (high - low) || Math.abs(high) || 1, bottom = low - margin, top = high + margin;
  const first = t[0], span = t.at(-1) - first || 1;
  canvas.className = "over-time";
  canvas.tabIndex = 0;
  for (const [key, text] of Object.entries({ role: "slider", "aria-label": `Time [s], in the plot of ${name}`,
    "aria-valuemin": first, "aria-valuemax": t.at(-1) })) canvas.setAttribute(key, text);
  legend.className = "over-time";
  const readings = curves.map((curve, k) => {
    const item = document.createElement("li"), mark = document.createElement("span"), value = document.createElement("span");
    mark.style.color = colors[k % colors.length];
    mark.textContent = "— ";
    mark.setAttribute("aria-hidden", "true");
    item.append(mark, `${curve.name} = `, value);
    legend.append(item);
    return value;
  });
  root.replaceChildren(canvas, legend);
  const short = (value) => Number(value.toPrecision(3)).toString();

  let drawn = "";
  const draw = () => {
    if (!canvas.isConnected) return;
    requestAnimationFrame(draw);
    const now = Math.min(Math.max(time(), first), t.at(-1)), { clientWidth: width, clientHeight: height } = canvas;
    const ink = getComputedStyle(root).color, state = [now, width, height, ink].join();
    if (state === drawn || !width) return;
    drawn = state;
    const scale = devicePixelRatio || 1, pen = canvas.getContext("2d");
    canvas.width = scale * width;
    canvas.height = scale * height;
    pen.scale(scale, scale);
    const x = (at) => ((at - first) / span) * (width - 2) + 1;
    const y = (value) => height - ((value - bottom) / (top - bottom)) * height;
    curves.forEach(({ values }, k) => {
      pen.strokeStyle = colors[k % colors.length];
      pen.lineWidth = 1.5;
      pen.beginPath();
      values.forEach((value, i) => pen.lineTo(x(t[i]), y(value)));
      pen.stroke();
    });
    pen.strokeStyle = pen.fillStyle = ink;
    pen.lineWidth = 1;
    pen.beginPath();
    pen.moveTo(x(now), 0);
    pen.lineTo(x(now), height);
    pen.stroke();
    pen.font = "11px system-ui, sans-serif";
    pen.fillText(short(high), 3, 11);
    pen.fillText(short(low), 3, height - 3);
    canvas.setAttribute("aria-valuenow", now.toFixed(3));
    const after = t.findIndex((one) => one >= now - 1e-9), i = Math.max(after, 1), gap = t[i] - t[i - 1];
    const share = t.length < 2 || !(gap > 0) ? 0 : Math.min(1, Math.max(0, (now - t[i - 1]) / gap));
    curves.forEach(({ values }, k) => {
      const value = t.length < 2 ? values[0] : values[i - 1] + share * (values[i] - values[i - 1]);
      readings[k].textContent = value.toPrecision(4);
    });
  };
  const at = (event) => first + (span * (event.offsetX - 1)) / (canvas.clientWidth - 2);
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    seek(Math.min(Math.max(at(event), first), first + span));
  });
  canvas.addEventListener("pointermove", (event) => {
    if (event.buttons & 1) seek(Math.min(Math.max(at(event), first), first + span));
  });
  canvas.addEventListener("keydown", (event) => {
    const steps = { ArrowLeft: -1, ArrowRight: 1, PageDown: -10, PageUp: 10, Home: -Infinity, End: Infinity };
    if (!(event.key in steps)) return;
    event.preventDefault();
    seek(Math.min(Math.max(time() + (steps[event.key] * span) / 100, first), first + span));
  });
  draw();
};
// Fields of React take what is typed; this types.
window.typeInto = (field, text) => {
  Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value").set.call(field, text);
  field.dispatchEvent(new Event("input", { bubbles: true }));
};
// In a view, a plot is what its server states of it.
document.addEventListener("DOMContentLoaded", () => {
  const slider = () => document.querySelector('#root [role="slider"][aria-label="time [s]"]');
  const field = () => document.querySelector('#root input[type="text"][aria-label="time [s]"]');
  const time = () => Number(slider()?.getAttribute("aria-valuenow") ?? 0);
  const seek = (to) => {
    if (!field()) return;
    window.typeInto(field(), to.toPrecision(6));
    field().dispatchEvent(new FocusEvent("focusout", { bubbles: true }));
  };
  new MutationObserver(() => {
    for (const root of document.querySelectorAll("[data-plot]")) {
      const data = root.dataset.plot;
      delete root.dataset.plot;
      window.plotOverTime(root, JSON.parse(data), time, seek);
    }
  }).observe(document.body, { childList: true, subtree: true });
});
