// -- curves ----------------------------------------------------------------------------------------------------------
const samples = floats(data.samples), errors = floats(data.errors), count = data.shown_frames;
const times = Float64Array.from({ length: count }, (_, i) => i * data.stride * data.frame_time);
const keys = data.keys && { times: floats(data.keys.times), values: floats(data.keys.values), slopes: floats(data.keys.slopes), in_slopes: floats(data.keys.in_slopes) };
const firstKey = [0];
for (const channel of data.channels) firstKey.push(firstKey[firstKey.length - 1] + channel.keys);

function keysOf(c) {
  const part = (name) => keys[name].subarray(firstKey[c], firstKey[c + 1]);
  return { t: part("times"), v: part("values"), out: part("slopes"), into: part("in_slopes") };
}

function smooth({ t, v, out, into }) {  // cubic Hermite through the keys, fine enough to look at
  const x = [], y = [], end = data.duration;
  if (t.length && t[0] > 0) { x.push(0); y.push(v[0]); }
  for (let k = 0; k + 1 < t.length; k++) {
    const h = t[k + 1] - t[k], steps = Math.max(2, Math.min(48, Math.ceil(2 * h / data.frame_time)));
    for (let i = 0; i < steps; i++) {
      const s = i / steps, r = 1 - s;
      x.push(t[k] + s * h);
      y.push((1 + 2 * s) * r * r * v[k] + s * r * r * h * out[k] + s * s * (3 - 2 * s) * v[k + 1] - s * s * r * h * into[k + 1]);
    }
  }
  if (t.length) { x.push(t[t.length - 1], Math.max(end, t[t.length - 1])); y.push(v[t.length - 1], v[t.length - 1]); }
  return { x, y };
}

function handles({ t, v, out, into }) {  // Bezier handles: a third of the way to the neighbour, along the slope
  const x = [], y = [];
  for (let k = 0; k < t.length; k++) {
    const before = k > 0 ? (t[k] - t[k - 1]) / 3 : 0, after = k + 1 < t.length ? (t[k + 1] - t[k]) / 3 : 0;
    x.push(t[k] - before, t[k], t[k] + after, null);
    y.push(v[k] - before * into[k], v[k], v[k] + after * out[k], null);
  }
  return { x, y };
}

function range(...lists) {
  let low = Infinity, high = -Infinity;
  for (const list of lists) for (const y of list) { if (y < low) low = y; if (y > high) high = y; }
  const margin = Math.max(0.07 * (high - low), 1e-6 * Math.abs(high), 1e-4);
  return low <= high ? [low - margin, high + margin] : [-1, 1];
}

let chosen = 0;

const keySize = (shown) => (shown > 300 ? 4 : shown > 90 ? 6 : 9);  // pixels, so that many keys do not hide the curve

function fitKeys() {  // after zooming: keys as large as there is room for
  const plot = $("curve-plot"), [low, high] = plot.layout.xaxis.range, named = (name) => plot.data.findIndex((trace) => name.test(trace.name));
  const size = keySize(keysOf(chosen).t.filter((t) => t >= low && t <= high).length);
  Plotly.restyle(plot, { "marker.size": [size, 0.45 * size] }, [named(/^[0-9,]+ keys?$/), named(/^tangents$/)]);
}

function showCurve(c) {
  chosen = c;
  const channel = data.channels[c], turns = channel.unit === "degrees", unit = turns ? "degrees" : "file units";
  const before = samples.subarray(c * count, (c + 1) * count), off = errors.subarray(c * count, (c + 1) * count);
  const dots = count <= 150 ? "lines+markers" : "lines", raw = early && early.subarray(c * count, (c + 1) * count);
  const traces = [], shown = [before];
  if (raw) traces.push({ x: times, y: raw, mode: dots, name: "captured", line: { color: CAPTURED, width: 1.3 }, marker: { size: 4 }, hovertemplate: "%{y:.4g}" });
  if (!raw || data.keyed) traces.push({ x: times, y: before, mode: dots, name: data.keyed ? `${whole(data.report.frames)} ${noise ? "clean samples" : "samples"}` : "first clip", line: { color: GREY, width: 3 }, marker: { size: 5 }, hovertemplate: "%{y:.4g}" });
  if (keys) {
    const k = keysOf(c), curve = smooth(k), handle = handles(k);
    shown.push(curve.y);
    traces.push({ ...curve, mode: "lines", name: "curve", line: { color: BLUE, width: 2 }, hoverinfo: "skip" });
    traces.push({ ...handle, mode: "lines+markers", name: "tangents", line: { color: ORANGE, width: k.t.length > 90 ? 1 : 1.5 }, marker: { size: 0.45 * keySize(k.t.length), color: ORANGE }, hoverinfo: "skip", cliponaxis: true });
    traces.push({ x: k.t, y: k.v, customdata: k.out, mode: "markers", name: `${whole(k.t.length)} ${k.t.length === 1 ? "key" : "keys"}`, marker: { color: RED, size: keySize(k.t.length), line: { color: "#fff", width: k.t.length > 300 ? 0 : 1 } }, hovertemplate: "key %{y:.4g}, slope %{customdata:.4g} per second" });
  } else {
    const after = before.map((y, i) => y + off[i]);
    shown.push(after);
    traces.push({ x: times, y: after, mode: "lines", name: cleaning ? "clean" : "second clip", line: { color: BLUE, width: 2 }, hovertemplate: "%{y:.4g}" });
  }
  if (noise) traces.push(...marks(c, raw || before, shown[1]));
  if (cleaning) traces.push(...noiseBand(c));
  const allowed = data.bands && data.bands[c];
  let limits = [];
  if (allowed !== null && allowed !== undefined) {
    const band = typeof allowed === "number" ? [[0, data.duration], [allowed, allowed]] : [times, floats(allowed)];
    limits = [Math.max(...band[1].filter(Number.isFinite)), -Math.max(...band[1].filter(Number.isFinite))];
    const edge = { x: band[0], mode: "lines", yaxis: "y2", line: { color: GREEN, width: 1, dash: "dot" }, hoverinfo: "skip", legendgroup: "tolerance" };
    traces.push({ ...edge, y: band[1].map((y) => -y), showlegend: false });
    traces.push({ ...edge, y: band[1], fill: "tonexty", fillcolor: "rgba(18,129,104,0.10)", name: "tolerance" });
  }
  traces.push({ x: times, y: off, mode: "lines", name: cleaning ? "change" : "error", yaxis: "y2", line: { color: RED, width: count > 1500 ? 0.8 : 1.3 }, hovertemplate: `${cleaning ? "change" : "error"} %{y:.3g}` });
  Plotly.react("curve-plot", traces, layout({
    xaxis: { title: { text: "seconds" }, zeroline: false, anchor: "y2", range: [-0.01 * data.duration, 1.01 * data.duration + 1e-6], hoverformat: ".3f" },
    yaxis: { title: { text: unit }, domain: [0.34, 1], range: raw ? focused(shown[1], data.keyed ? raw : before) : range(...shown) },
    yaxis2: { title: { text: `${cleaning ? "change" : "error"}, ${unit}` }, domain: [0, 0.26], range: range(cleaning ? unmasked(c, off) : off, limits, [0]) },
    shapes: shades(c), hovermode: "x unified", dragmode: "zoom",
  }), CONFIG);
  $("curve-name").textContent = channel.name;
  const told = [`largest ${cleaning ? "change" : "error"} ${three(channel.max)} ${unit}, RMS ${three(channel.rms)}`];
  if (noise) told.unshift(...noiseHint(c));
  if (spectra) showSpectrum(c);
  if (channel.lower_bound) told.push(`${whole(channel.keys)} keys, at least ${whole(channel.lower_bound)} are needed`);
  if (data.bands && data.bands.every((band) => band === null)) told.push("the tolerance holds in space, so it sets no band on the channel itself");
  if (data.stride > 1) told.push(`every ${data.stride}th frame is drawn, with the largest error of those between`);
  $("curves-hint").textContent = told.join(" · ") + ". Drag to zoom, double-click to see all again; click the curve to see the figure at that time.";
}
// -- the chooser: a filtered list; arrow keys move, the curve follows ---------------------------------------------------
const list = $("channels"), options = [];

function listed() {
  const words = $("search").value.toLowerCase().split(/\s+/).filter(Boolean), order = $("order").value;
  const found = data.channels.map((_, c) => c).filter((c) => words.every((w) => data.channels[c].name.toLowerCase().includes(w)));
  const alike = (c) => (data.channels[c].unit === "degrees" ? 1 : data.degree_length);
  const size = (c) => data.channels[c].max / alike(c), sigma = (c) => (noise.channels[c] ? noise.channels[c].sigma / alike(c) : -1);
  if (order === "error") found.sort((a, b) => size(b) - size(a));
  if (order === "noise") found.sort((a, b) => sigma(b) - sigma(a));
  if (order === "keys") found.sort((a, b) => data.channels[b].keys - data.channels[a].keys);
  return found;
}

function fillList() {
  const found = listed();
  list.replaceChildren();
  options.length = 0;
  let joint = null;
  for (const c of found) {
    const channel = data.channels[c], grouped = $("order").value === "tree";
    if (grouped && channel.joint !== joint) {
      joint = channel.joint;
      const head = element("li", data.joints[joint].name, { class: "joint", role: "presentation" });
      head.style.paddingLeft = `${8 + 7 * Math.min(data.joints[joint].depth, 12)}px`;
      list.append(head);
    }
    const option = element("li", "", { role: "option", id: `channel-${c}`, "aria-selected": String(c === chosen), title: channel.name });
    option.append(element("span", grouped ? channel.kind : channel.name), element("span", cleaning ? noiseOf(c) : whole(channel.keys)), element("span", `${three(channel.max)}${channel.unit === "degrees" ? "°" : " u"}`));
    if (grouped) option.firstChild.style.paddingLeft = `${12 + 7 * Math.min(data.joints[joint].depth, 12)}px`;
    option.addEventListener("click", () => choose(c));
    options.push(c);
    list.append(option);
  }
  if (!found.length) list.append(element("li", "no channel has this name", { class: "none", role: "presentation" }));
}

function choose(c) {
  const old = $(`channel-${chosen}`);
  if (old) old.setAttribute("aria-selected", "false");
  showCurve(c);
  const now = $(`channel-${c}`);
  if (!now) return;
  now.setAttribute("aria-selected", "true");
  $("search").setAttribute("aria-activedescendant", now.id);
  const above = now.offsetTop - list.offsetTop, lower = above + now.offsetHeight;
  if (above < list.scrollTop) list.scrollTop = above - 26;
  else if (lower > list.scrollTop + list.clientHeight) list.scrollTop = lower - list.clientHeight + 6;
}

function moveChoice(event) {
  const step = { ArrowDown: 1, ArrowUp: -1, PageDown: 10, PageUp: -10 }[event.key];
  if (!options.length || (!step && event.key !== "Enter")) return;
  event.preventDefault();
  const place = options.indexOf(chosen);
  choose(options[step ? Math.max(0, Math.min(options.length - 1, place < 0 ? 0 : place + step)) : Math.max(0, place)]);
}

function startCurves() {
  if (!data.channels.length) {
    $("curves").hidden = true;
    return;
  }
  $("keys-head").textContent = data.keyed ? "keys" : cleaning ? "noise" : "samples";
  if (noise) $("order").append(element("option", "most noise", { value: "noise" }));
  if (cleaning) $("error-head").textContent = "max change";
  if (cleaning) for (const option of [...$("order").options]) { if (option.value === "keys") option.remove(); if (option.value === "error") option.textContent = "largest change"; }
  fillList();
  $("search").addEventListener("input", () => { fillList(); if (options.length && !options.includes(chosen)) choose(options[0]); });
  $("order").addEventListener("change", () => { fillList(); choose(chosen); });
  $("search").addEventListener("keydown", moveChoice);
  list.addEventListener("keydown", moveChoice);
  list.tabIndex = 0;
  choose(data.first_channel);
  if (keys) $("curve-plot").on("plotly_relayout", fitKeys);
  $("curve-plot").on("plotly_click", (event) => seek(event.points[0].x));
}
