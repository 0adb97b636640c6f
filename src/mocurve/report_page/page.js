"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const $ = (id) => document.getElementById(id);
  const BLUE = "#1b497d", RED = "#d1495b", GREY = "#9aa5b1", ORANGE = "#e8a33d", GREEN = "#128168", INK = "#1d2733", LINE = "#e4e9ee";
  const mm = data.millimetres;  // of a file unit; null where nobody said
  const LENGTH = mm === null ? "units" : "mm";
  const length = (x) => (mm === null ? x : x * mm);
  const three = (x) => (x === 0 ? "0" : Math.abs(x) >= 1000 ? Math.round(x).toLocaleString("en") : String(+x.toPrecision(3)));
  const whole = (x) => x.toLocaleString("en");
  const literal = (s) => s.replace(/&/g, "&amp;").replace(/</g, "&lt;");  // Plotly reads tags in texts
  const CONFIG = { displaylogo: false, responsive: true, modeBarButtonsToRemove: ["lasso2d", "select2d", "autoScale2d"] };

  function floats(text) {
    const raw = atob(text), bytes = new Uint8Array(raw.length);
    for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
    return new Float32Array(bytes.buffer);
  }

  function element(kind, text, attributes = {}) {
    const made = document.createElement(kind);
    made.textContent = text;
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
    return made;
  }

  function layout(more) {
    const axis = { gridcolor: LINE, zerolinecolor: "#c5ced8", linecolor: "#c5ced8", ticks: "outside", tickcolor: "#c5ced8", automargin: true };
    const base = {
      font: { family: getComputedStyle(document.body).fontFamily, size: 13, color: INK },
      paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "#fff", margin: { l: 64, r: 14, t: 34, b: 44 },
      hoverlabel: { font: { size: 13 } }, legend: { orientation: "h", x: 0, y: 1.0, yanchor: "bottom" },
    };
    for (const name of Object.keys(more)) if (/^[xy]axis/.test(name)) more[name] = { ...axis, ...more[name] };
    return { ...base, ...more };
  }

  // -- the numbers in plain words --------------------------------------------------------------------------------------
  function showNumbers() {
    const r = data.report, cards = [];
    if (data.keyed) {
      cards.push([whole(r.keys), `keys instead of ${whole(r.samples)} samples`]);
      cards.push([`1 for ${three(r.ratio)}`, `one key for so many samples; ${three(100 * r.keys / Math.max(r.samples, 1))} % are left`]);
    } else {
      cards.push([whole(r.keys), `samples, against ${whole(r.samples)} in the first clip`]);
    }
    const world = mm === null ? [three(r.max_error_world), "units"] : [three(length(r.max_error_world)), "mm"];
    const guess = data.guess ? `; about ${three(r.max_error_world * data.guess.millimetres)} mm if the length unit is what the body's height suggests, ${data.guess.name}` : "";
    cards.push([`${world[0]} ${world[1]}`, `is the furthest that any joint is off in space${mm === null ? guess : `; ${three(r.max_error_world)} in the file's unit`}`]);
    if (r.max_error_degrees !== null) cards.push([`${three(r.max_error_degrees)}°`, `is the furthest that any rotation channel is off; RMS ${three(r.rms_error_degrees)}°`]);
    if (r.over_bound !== null) cards.push([`${r.over_bound.toFixed(2)}×`, `the proven least: ${whole(r.lower_bound)} keys are needed at this tolerance`]);
    for (const [number, words] of cards) {
      const card = document.createElement("div");
      card.append(element("b", number), element("span", words));
      $("numbers").append(card);
    }
    const made = [["tolerance", r.tolerance], ["method", r.method], ["keys aligned by", r.align], ["quality", r.quality]];
    const told = made.filter(([, value]) => value).map(([name, value]) => `${name} ${value}`);
    if (r.seconds !== null) told.push(`made in ${three(r.seconds)} s`);
    told.push(`${whole(r.frames)} frames, ${three(data.duration)} s at ${three(1 / data.frame_time)} frames a second`);
    $("made").textContent = told.join(" · ");
  }

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
    const dots = count <= 150 ? "lines+markers" : "lines";
    const traces = [{ x: times, y: before, mode: dots, name: data.keyed ? `${whole(data.report.frames)} samples` : "first clip", line: { color: GREY, width: 3 }, marker: { size: 5 }, hovertemplate: "%{y:.4g}" }];
    const shown = [before];
    if (keys) {
      const k = keysOf(c), curve = smooth(k), handle = handles(k);
      shown.push(curve.y);
      traces.push({ ...curve, mode: "lines", name: "curve", line: { color: BLUE, width: 2 }, hoverinfo: "skip" });
      traces.push({ ...handle, mode: "lines+markers", name: "tangents", line: { color: ORANGE, width: k.t.length > 90 ? 1 : 1.5 }, marker: { size: 0.45 * keySize(k.t.length), color: ORANGE }, hoverinfo: "skip", cliponaxis: true });
      traces.push({ x: k.t, y: k.v, customdata: k.out, mode: "markers", name: `${whole(k.t.length)} ${k.t.length === 1 ? "key" : "keys"}`, marker: { color: RED, size: keySize(k.t.length), line: { color: "#fff", width: k.t.length > 300 ? 0 : 1 } }, hovertemplate: "key %{y:.4g}, slope %{customdata:.4g} per second" });
    } else {
      const after = before.map((y, i) => y + off[i]);
      shown.push(after);
      traces.push({ x: times, y: after, mode: "lines", name: "second clip", line: { color: BLUE, width: 2 }, hovertemplate: "%{y:.4g}" });
    }
    const allowed = data.bands && data.bands[c];
    let limits = [];
    if (allowed !== null && allowed !== undefined) {
      const band = typeof allowed === "number" ? [[0, data.duration], [allowed, allowed]] : [times, floats(allowed)];
      limits = [Math.max(...band[1].filter(Number.isFinite)), -Math.max(...band[1].filter(Number.isFinite))];
      const edge = { x: band[0], mode: "lines", yaxis: "y2", line: { color: GREEN, width: 1, dash: "dot" }, hoverinfo: "skip", legendgroup: "tolerance" };
      traces.push({ ...edge, y: band[1].map((y) => -y), showlegend: false });
      traces.push({ ...edge, y: band[1], fill: "tonexty", fillcolor: "rgba(18,129,104,0.10)", name: "tolerance" });
    }
    traces.push({ x: times, y: off, mode: "lines", name: "error", yaxis: "y2", line: { color: RED, width: 1.3 }, hovertemplate: "error %{y:.3g}" });
    Plotly.react("curve-plot", traces, layout({
      xaxis: { title: { text: "seconds" }, zeroline: false, anchor: "y2", range: [-0.01 * data.duration, 1.01 * data.duration + 1e-6], hoverformat: ".3f" },
      yaxis: { title: { text: unit }, domain: [0.34, 1], range: range(...shown) },
      yaxis2: { title: { text: `error, ${unit}` }, domain: [0, 0.26], range: range(off, limits, [0]) },
      hovermode: "x unified", dragmode: "zoom",
    }), CONFIG);
    $("curve-name").textContent = channel.name;
    const told = [`largest error ${three(channel.max)} ${unit}, RMS ${three(channel.rms)}`];
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
    const size = (c) => data.channels[c].max / (data.channels[c].unit === "degrees" ? 1 : data.degree_length);
    if (order === "error") found.sort((a, b) => size(b) - size(a));
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
      option.append(element("span", grouped ? channel.kind : channel.name), element("span", whole(channel.keys)), element("span", `${three(channel.max)}${channel.unit === "degrees" ? "°" : " u"}`));
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
    $("keys-head").textContent = data.keyed ? "keys" : "samples";
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

  // -- two figures in space ----------------------------------------------------------------------------------------------
  const poses = data.poses, a = floats(poses.a), b = floats(poses.b), J = data.joints.length;
  const bones = data.joints.map((joint, j) => [joint.parent, j]).filter(([parent]) => parent >= 0);
  let playing = null, frame = 0;

  function centre(n) {  // where the floor under the figure is drawn: under the original's root, or at the middle of the clip
    return $("follow").checked ? [poses.way[2 * n], poses.way[2 * n + 1]] : poses.middle;
  }

  function camera() { return $("figures").layout?.scene?.camera || CAMERA; }

  function behind() {  // a little away from the viewer, so that the original does not flicker through what lies on it
    const { eye } = camera(), far = Math.hypot(eye.x, eye.y, eye.z), step = -0.012 * (poses.top - poses.floor) / far;
    return [step * eye.x, step * eye.y, step * eye.z];
  }

  function figure(places, n, by = [0, 0, 0]) {  // (x, y up, z) -> Plotly's (x, -z, y): upright, seen from the front
    const [cx, cz] = centre(n), bone = { x: [], y: [], z: [] }, joint = { x: [], y: [], z: [] };
    const at = (j) => { const i = 3 * (n * J + j); return [places[i] - cx + by[0], cz - places[i + 2] + by[1], places[i + 1] + by[2]]; };
    const put = (target, p) => { target.x.push(p[0]); target.y.push(p[1]); target.z.push(p[2]); };
    for (const [from, to] of bones) { put(bone, at(from)); put(bone, at(to)); put(bone, [null, null, null]); }
    for (let j = 0; j < J; j++) put(joint, at(j));
    return { bone, joint };
  }

  function floor(n) {
    const [cx, cz] = centre(n), s = poses.square, half = box(), lines = { x: [], y: [], z: [] };
    const put = (x, y) => { lines.x.push(x); lines.y.push(y); lines.z.push(x === null ? null : poses.floor); };
    for (let x = Math.ceil((cx - half[0]) / s) * s; x <= cx + half[0]; x += s) { put(x - cx, -half[1]); put(x - cx, half[1]); put(null, null); }
    for (let z = Math.ceil((cz - half[1]) / s) * s; z <= cz + half[1]; z += s) { put(-half[0], cz - z); put(half[0], cz - z); put(null, null); }
    return lines;
  }

  function box() { return $("follow").checked ? poses.near : poses.whole; }  // half extents along X and Z, length units

  function jointErrors(n) {
    return Array.from({ length: J }, (_, j) => {
      const i = 3 * (n * J + j);
      return length(Math.hypot(a[i] - b[i], a[i + 1] - b[i + 1], a[i + 2] - b[i + 2]));
    });
  }

  function figureTraces(n) {
    const first = figure(a, n), ghost = figure(a, n, behind()), second = figure(b, n), off = jointErrors(n), ground = floor(n);
    const names = data.joints.map((joint) => literal(joint.name));
    const line = (place, scene, color, width) => ({ type: "scatter3d", mode: "lines", ...place, scene, line: { color, width }, hoverinfo: "skip", showlegend: false });
    return [
      line(ground, "scene", "#d3dae2", 1.5), line(ground, "scene2", "#d3dae2", 1.5),
      line(first.bone, "scene", BLUE, 7), line(ghost.bone, "scene2", "#e3b7b0", 9), line(second.bone, "scene2", GREEN, 6),
      { type: "scatter3d", mode: "markers", ...first.joint, scene: "scene", text: names, hovertemplate: "%{text}<extra></extra>", marker: { size: 3.2, color: BLUE }, showlegend: false },
      { type: "scatter3d", mode: "markers", ...second.joint, scene: "scene2", text: names, customdata: off, hovertemplate: `%{text}: %{customdata:.3g} ${LENGTH} off<extra></extra>`, marker: { size: 3.6, color: off, cmin: 0, cmax: Math.max(length(data.report.max_error_world), 1e-9), colorscale: [[0, GREEN], [0.5, ORANGE], [1, RED]], showscale: true, colorbar: { orientation: "h", title: { text: `error of the joints, ${LENGTH}`, side: "top", font: { size: 12 } }, thickness: 8, len: 0.4, x: 0.753, xanchor: "center", y: 0, yanchor: "top", ypad: 4, tickfont: { size: 11 }, outlinewidth: 0 } }, showlegend: false },
    ];
  }

  function sceneLayout(domain, view) {
    const [x, z] = box(), high = poses.top - poses.floor, largest = Math.max(1.24 * x, 1.24 * z, high), axis = { visible: false, showspikes: false };
    const part = (extent) => 1.35 * extent / largest;
    return {
      domain, camera: view, aspectmode: "manual", aspectratio: { x: part(2 * x), y: part(2 * z), z: part(high) }, dragmode: "orbit", bgcolor: "#fafbfc",
      xaxis: { ...axis, range: [-x, x] }, yaxis: { ...axis, range: [-z, z] }, zaxis: { ...axis, range: [poses.floor - 1e-3 * high, poses.top] },
    };
  }

  const CAMERA = { eye: { x: 1.15, y: -1.7, z: 0.5 }, center: { x: 0, y: 0, z: -0.03 }, up: { x: 0, y: 0, z: 1 } };

  function drawFigures() {
    const label = (text, x) => ({ text, x, y: 1.0, xref: "paper", yref: "paper", yanchor: "bottom", showarrow: false, font: { size: 14 } });
    const titles = data.keyed ? ["original", "from the keys"] : ["first clip", "second clip"];
    return Plotly.react("figures", figureTraces(frame), layout({
      margin: { l: 0, r: 0, t: 26, b: 46 }, annotations: [label(titles[0], 0.247), label(titles[1], 0.753)],
      scene: sceneLayout({ x: [0, 0.495], y: [0, 1] }, camera()), scene2: sceneLayout({ x: [0.505, 1], y: [0, 1] }, camera()),
    }), { ...CONFIG, displayModeBar: false, scrollZoom: true });
  }

  function moveFigures() {
    const traces = figureTraces(frame), all = (part) => traces.map((trace) => trace[part]);
    const colours = traces.map((trace) => (trace.customdata ? trace.customdata : trace.marker ? trace.marker.color : undefined));
    Plotly.restyle("figures", { x: all("x"), y: all("y"), z: all("z"), customdata: all("customdata"), "marker.color": colours });
  }

  function show(n) {
    frame = n;
    $("frame").value = String(n);
    const seconds = n / poses.fps;
    $("time").textContent = `${seconds.toFixed(2)} / ${data.duration.toFixed(2)} s`;
    moveFigures();
  }

  function seek(seconds) { show(Math.max(0, Math.min(poses.count - 1, Math.round(seconds * poses.fps)))); }

  function play() {
    if (playing !== null) { pause(); return; }
    $("play").textContent = "Pause";
    let last = performance.now(), at = frame >= poses.count - 1 ? 0 : frame;
    const step = (now) => {
      at = (at + Math.max(0, now - last) / 1000 * poses.fps * Number($("speed").value)) % Math.max(poses.count, 1);
      last = now;
      if (Math.floor(at) !== frame) show(Math.floor(at));
      playing = requestAnimationFrame(step);
    };
    playing = requestAnimationFrame(step);
  }

  function pause() {
    cancelAnimationFrame(playing);
    playing = null;
    $("play").textContent = "Play";
  }

  function startFigures() {
    if (!poses.count) {
      $("space").hidden = true;
      return;
    }
    $("frame").max = String(poses.count - 1);
    $("follow").checked = poses.travels;
    drawFigures();
    show(0);
    $("play").addEventListener("click", play);
    $("frame").addEventListener("input", () => { if (playing !== null) pause(); show(Number($("frame").value)); });
    $("follow").addEventListener("change", drawFigures);
    let turning = false;
    const together = (event) => {  // turning one view turns the other
      const turned = event["scene.camera"] || event["scene2.camera"];
      if (!turned || turning) return;
      turning = true;
      const other = event["scene.camera"] ? "scene2.camera" : "scene.camera";
      Plotly.relayout("figures", { [other]: turned }).then(() => { turning = false; moveFigures(); });
    };
    $("figures").on("plotly_relayouting", together);
    $("figures").on("plotly_relayout", together);
  }

  // -- errors of joints ----------------------------------------------------------------------------------------------------
  function showJoints() {
    const rows = data.joints.map((joint) => ({ name: joint.name, tolerance: joint.tolerance, max: length(joint.max), rms: length(joint.rms) })).sort((x, y) => y.max - x.max);
    const place = rows.map((_, i) => i), names = rows.map((row) => literal(row.name));
    const high = Math.max(220, 70 + 19 * rows.length);
    const bar = (part, name, color, width) => ({ type: "bar", orientation: "h", y: place, x: rows.map((row) => row[part]), customdata: names, name, marker: { color }, width, hovertemplate: `%{customdata}: %{x:.3g} ${LENGTH}` });
    const limits = rows.map((row) => (row.tolerance === null ? null : length(row.tolerance)));
    const marks = { type: "scatter", mode: "markers", x: limits, y: place, name: "tolerance", marker: { symbol: "line-ns", size: 13, line: { color: RED, width: 2 } }, hovertemplate: `tolerance %{x:.3g} ${LENGTH}` };
    const bars = [bar("max", "largest", "#a9c3de", 0.78), bar("rms", "RMS", BLUE, 0.34)];
    $("joint-plot").style.height = `${high}px`;
    Plotly.newPlot("joint-plot", limits.some((x) => x !== null) ? [...bars, marks] : bars, layout({
      barmode: "overlay", hovermode: "closest", margin: { l: 64, r: 20, t: 40, b: 44 }, legend: { orientation: "h", x: 1, xanchor: "right", y: 1, yanchor: "bottom", traceorder: "normal" },
      xaxis: { title: { text: mm === null ? "file units" : "millimetres" }, rangemode: "tozero" },
      yaxis: { tickvals: place, ticktext: names, range: [rows.length - 0.4, -0.6], tickfont: { size: 12 }, fixedrange: true },
    }), CONFIG);
    const worst = rows.length ? `${rows[0].name} is furthest off, ${three(rows[0].max)} ${LENGTH}` : "";
    $("joints-hint").textContent = `Distance in space between the two clips, joints and end sites, all frames, the furthest first. ${worst}.`;
  }

  // -- keys against tolerance, error against ratio (Önder 2007, figures 4.5 and 4.7) ---------------------------------------
  function showSweep() {
    if (!data.sweep) return;
    $("sweep").hidden = false;
    $("sweep-hint").textContent = data.sweep.words;
    const colours = { optimal: BLUE, "optimal, held in space": GREEN, split: ORANGE, "split by ratio": RED };
    const traces = (x, y) => data.sweep.lines.filter((line) => line[x] !== null).map((line) => ({
      x: line[x], y: line[y], text: line.labels, name: literal(line.name), mode: "lines+markers", line: { color: colours[line.name], width: 2 }, marker: { size: 7 },
      hovertemplate: "%{text}: %{x:.3g}, %{y:.3g}",
    }));
    const here = { x: [data.sweep.here.percent], y: [length(data.sweep.here.world)], text: ["this clip"], name: "this page", mode: "markers", marker: { symbol: "star", size: 15, color: INK, line: { color: "#fff", width: 1 } }, hovertemplate: "these keys: %{x:.3g} %, %{y:.3g}" };
    const log = (title) => ({ title: { text: title }, type: "log", dtick: "D2" });
    const margin = { l: 64, r: 14, t: 66, b: 48 }, legend = { orientation: "h", x: 0, y: 1.01, yanchor: "bottom" };
    const least = { x: data.sweep.bound.tolerance, y: data.sweep.bound.keys, mode: "lines", name: "proven least", line: { color: GREY, width: 2, dash: "dot" }, hovertemplate: "at least %{y:.3g}" };
    Plotly.newPlot("keys-plot", [...traces("tolerance", "keys"), least], layout({ margin, legend, xaxis: log("tolerance, degrees"), yaxis: log("keys a channel, on the average"), hovermode: "closest" }), CONFIG);
    const space = traces("percent", "world");
    for (const trace of space) trace.y = trace.y.map(length);
    Plotly.newPlot("ratio-plot", data.keyed ? [...space, here] : space, layout({ margin, legend, xaxis: log("keys left, % of the samples"), yaxis: log(`largest error in space, ${LENGTH}`), hovermode: "closest" }), CONFIG);
  }

  showNumbers();
  startCurves();
  startFigures();
  showJoints();
  showSweep();
})();
