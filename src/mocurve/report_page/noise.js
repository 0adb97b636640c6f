// -- noise: what cleaning found ------------------------------------------------------------------------------------------
const noise = data.noise, cleaning = Boolean(noise) && !data.keyed;  // not reduced: the second clip is the clean one
const early = noise && noise.captured ? floats(noise.captured) : null;
const spectra = noise && noise.spectra && { hertz: floats(noise.spectra.hertz), before: floats(noise.spectra.before), after: floats(noise.spectra.after) };
const KIND = { lost: "#5f6f80", frozen: "#0b8f9c", spike: "#c026a8", run: "#7c4ddb", offset: "#a86f12" };
const CAPTURED = "#a7b1bc", MOST_SHADES = 500, MOST_ROWS = 1000, HERTZ = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500];

const span = (row) => (row.first === row.last ? `frame ${row.first}` : `frames ${row.first}–${row.last}`);
const lasting = (t) => (t < 1 ? `${Math.round(1000 * t)} ms` : `${t.toFixed(2)} s`);
const degrees = (c) => data.channels[c].unit === "degrees";
const shortUnit = (c) => (degrees(c) ? "°" : " units");

function noiseCards() {
  const cards = [];
  for (const [turns, what] of [[true, "rotation"], [false, "position"]]) {
    const rows = noise.channels.map((row, c) => [row, c]).filter(([row, c]) => row && degrees(c) === turns).sort((x, y) => x[0].sigma - y[0].sigma);
    if (!rows.length) continue;
    const middle = rows[rows.length >> 1][0].sigma, [most, c] = rows[rows.length - 1];
    const size = (x) => (turns ? `${three(x)}°` : `${three(length(x))} ${LENGTH}`);
    cards.push([size(middle), `is the noise of ${rows.length === 1 ? "one" : `${rows.length} moving`} ${what} channel${rows.length === 1 ? "" : "s"} (sigma${rows.length === 1 ? "" : `, the middle one; most: ${size(most.sigma)} in ${data.channels[c].name}`})`]);
  }
  const offsets = noise.artefacts.filter((row) => row.kind === "offset").length, others = noise.artefacts.length - offsets;
  const done = noise.marked ? "marked and kept" : "filled in";
  cards.push([whole(noise.artefacts.length), `artefact${noise.artefacts.length === 1 ? "" : "s"}${others ? `; ${whole(noise.samples)} sample${noise.samples === 1 ? "" : "s"} ${done}` : ""}${offsets ? `; ${whole(offsets)} displaced part${offsets === 1 ? "" : "s"} ${noise.marked ? "kept" : "moved back"}` : ""}`]);
  return cards;
}

const noiseOf = (c) => (noise.channels[c] ? `${three(noise.channels[c].sigma)}${degrees(c) ? "°" : " u"}` : "–");

const artefactsOf = (c) => (noise ? noise.artefacts.filter((row) => row.channels.includes(c)) : []);

function shades(c) {  // masked frames, through both halves of the curve plot
  return artefactsOf(c).slice(0, MOST_SHADES).map((row) => ({
    type: "rect", xref: "x", yref: "paper", x0: (row.first - 0.5) * data.frame_time, x1: (row.last + 0.5) * data.frame_time, y0: 0, y1: 1,
    layer: "below", fillcolor: KIND[row.kind], opacity: 0.16, line: { width: 1, color: KIND[row.kind] },
  }));
}

function marks(c, before, after) {  // the samples that were no motion; hovering tells kind and frames
  const traces = [];
  for (const kind of Object.keys(noise.kinds)) {
    const rows = artefactsOf(c).filter((row) => row.kind === kind), x = [], y = [], text = [];
    for (const row of rows) {
      const said = `${kind}, ${span(row)}${row.by === null ? "" : `, off by ${three(row.by)}${shortUnit(c)}`}`;
      for (let i = Math.floor(row.first / data.stride); i <= Math.floor(row.last / data.stride) && i < count; i++) {
        x.push(times[i]);
        y.push(Number.isNaN(before[i]) ? after[i] : before[i]);
        text.push(said);
      }
      x.push(null); y.push(null); text.push("");
    }
    const style = kind === "offset" ? { mode: "lines", line: { color: KIND[kind], width: 2 } } : { mode: "markers", marker: { color: KIND[kind], size: 6, symbol: kind === "lost" ? "circle-open" : "circle" } };
    if (rows.length) traces.push({ x, y, text, name: kind, ...style, hovertemplate: "%{text}<extra></extra>" });
  }
  return traces;
}

function noiseBand(c) {
  const row = noise.channels[c];
  if (!row || !row.sigma) return [];
  const edge = { x: [0, data.duration], mode: "lines", yaxis: "y2", line: { color: GREEN, width: 1, dash: "dot" }, hoverinfo: "skip", legendgroup: "noise" };
  return [
    { ...edge, y: [-2 * row.sigma, -2 * row.sigma], showlegend: false },
    { ...edge, y: [2 * row.sigma, 2 * row.sigma], fill: "tonexty", fillcolor: "rgba(18,129,104,0.10)", name: "noise, ±2 sigma" },
  ];
}

function unmasked(c, values) {  // without the frames of artefacts, which would make the rest look flat
  const out = Float32Array.from(values);
  for (const row of artefactsOf(c)) out.fill(NaN, Math.floor(row.first / data.stride), Math.floor(row.last / data.stride) + 1);
  return out;
}

function focused(after, before) {  // range of the clean curve and what leaves it by no more than its own height
  const [low, high] = range(after), [least, most] = range(after, before), room = 0.8 * (high - low);
  return [Math.max(least, low - room), Math.min(most, high + room)];
}

function noiseHint(c) {
  const row = noise.channels[c];
  if (!row) return ["not looked at: it does not move, has too few samples, or was not chosen"];
  const told = [`noise ${three(row.sigma)}${shortUnit(c)} (sigma)`];
  if (!row.floor) told.push("no white noise floor found: what shakes here cannot be told from motion");
  return told;
}

function showSpectrum(c) {
  $("spectrum-name").textContent = data.channels[c].name;
  const size = spectra.hertz.length, before = spectra.before.subarray(c * size, (c + 1) * size), after = spectra.after.subarray(c * size, (c + 1) * size);
  const row = noise.channels[c], unit = degrees(c) ? "degrees" : "file units", top = Math.max(...before, ...after);
  const positive = (list) => Math.min(...list.filter((x) => x > 0)), low = Math.max(positive(after), positive(before) / 30, 1e-6 * top);
  const limits = top > 0 ? [0.7 * low, 2 * top] : [0.1, 1];
  const line = (y, name, color, width) => ({ x: spectra.hertz, y, name, mode: "lines", line: { color, width }, hovertemplate: `%{y:.3g} at %{x:.3g} Hz` });
  const traces = [line(before, "captured", CAPTURED, 2), line(after, data.keyed ? "keys" : "clean", BLUE, 2)];
  if (row && row.sigma) {
    const floor = row.sigma * Math.sqrt(2 * data.frame_time);
    traces.push({ x: [spectra.hertz[0], spectra.hertz[size - 1]], y: [floor, floor], name: `white noise of ${three(row.sigma)}${shortUnit(c)}`, mode: "lines", line: { color: GREEN, width: 1.5, dash: "dot" }, hoverinfo: "skip" });
  }
  if (row && row.cutoff && row.cutoff < 0.49 / data.frame_time) traces.push({ x: [row.cutoff, row.cutoff], y: limits, name: `halved at ${three(row.cutoff)} Hz`, mode: "lines", line: { color: ORANGE, width: 1.5, dash: "dash" }, hoverinfo: "skip" });
  Plotly.react("spectrum-plot", traces, layout({
    margin: { l: 64, r: 14, t: 58, b: 44 }, hovermode: "closest",
    xaxis: { title: { text: "Hz" }, type: "log", tickvals: HERTZ, ticktext: HERTZ.map(String), range: [Math.log10(spectra.hertz[0]), Math.log10(spectra.hertz[size - 1])] },
    yaxis: { title: { text: `${unit} / √Hz` }, type: "log", tickformat: "~g", dtick: 1, range: limits.map(Math.log10) },
  }), CONFIG);
}

function goTo(row) {
  const begin = row.first * data.frame_time, lasts = (row.last - row.first + 1) * data.frame_time, around = Math.max(0.35, lasts);
  if (!options.includes(row.channels[0])) { $("search").value = ""; fillList(); }
  choose(row.channels[0]);
  Plotly.relayout("curve-plot", { "xaxis.range": [Math.max(-0.01, begin - around), Math.min(1.01 * data.duration, begin + lasts + around)] });
  if (poses.count) seek(begin + lasts / 2);
  $("curves").scrollIntoView({ block: "start" });
}

function fillArtefacts() {
  const kind = $("kind").value, rows = noise.artefacts.filter((row) => row.channels.length && (!kind || row.kind === kind));
  if ($("artefact-order").value === "longest") rows.sort((x, y) => y.last - y.first - (x.last - x.first));
  $("artefacts").replaceChildren(...rows.slice(0, MOST_ROWS).map((row) => {
    const names = row.channels.map((c) => data.channels[c].kind).join(" "), button = element("button", "", { type: "button", title: `${row.joint} ${names}: ${row.kind}, ${noise.kinds[row.kind]}` });
    const place = element("span", row.joint), told = element("span", row.kind, { class: "kind" });
    place.append(element("small", ` ${names}`));
    told.style.setProperty("--kind", KIND[row.kind]);
    const frames = row.first === row.last ? String(row.first) : `${row.first}–${row.last}`;
    button.append(place, told, element("span", frames), element("span", `${(row.first * data.frame_time).toFixed(2)} s`), element("span", lasting((row.last - row.first + 1) * data.frame_time)));
    button.addEventListener("click", () => goTo(row));
    const item = document.createElement("li");
    item.append(button);
    return item;
  }));
  if (rows.length > MOST_ROWS) $("artefacts").append(element("li", `${whole(rows.length - MOST_ROWS)} more; choose a kind to see them`, { class: "none" }));
  if (!rows.length) $("artefacts").append(element("li", "none was found", { class: "none" }));
}

function showLevels() {  // a dot a channel, a line a joint; hollow where no white noise was found
  const looked = noise.channels.map((row, c) => c).filter((c) => noise.channels[c]), joints = [...new Set(looked.map((c) => data.channels[c].joint))];
  const colours = { X: RED, Y: GREEN, Z: BLUE }, sides = [true, false].filter((turns) => looked.some((c) => degrees(c) === turns)), traces = [];
  for (const turns of sides) {
    for (const axis of "XYZ") {
      const rows = looked.filter((c) => degrees(c) === turns && data.channels[c].kind[0] === axis);
      const size = (c) => (turns ? noise.channels[c].sigma : length(noise.channels[c].sigma)), cutoff = (c) => (noise.channels[c].cutoff ? `<br>halved at ${three(noise.channels[c].cutoff)} Hz` : "");
      traces.push({
        x: rows.map(size), y: rows.map((c) => joints.indexOf(data.channels[c].joint)), customdata: rows, text: rows.map((c) => literal(data.channels[c].name) + cutoff(c) + (noise.channels[c].floor ? "" : "<br>no white noise floor")),
        xaxis: turns || sides.length === 1 ? "x" : "x2", name: axis, legendgroup: axis, showlegend: turns === sides[0], mode: "markers",
        marker: { color: colours[axis], size: 8, symbol: rows.map((c) => (noise.channels[c].floor ? "circle" : "circle-open")) }, hovertemplate: `%{text}<br>sigma %{x:.3g} ${turns ? "degrees" : LENGTH}<extra></extra>`,
      });
    }
  }
  const title = (turns) => (turns ? "rotations, degrees" : `positions, ${LENGTH}`), narrow = window.innerWidth < 700;
  const axis = (turns) => ({ title: { text: title(turns), font: { size: narrow ? 11 : 13 } }, rangemode: "tozero", nticks: narrow ? 3 : turns ? 8 : 5, tickangle: 0, tickfont: { size: narrow ? 11 : 13 } });
  $("level-plot").style.height = `${Math.max(220, 96 + 19 * joints.length)}px`;
  Plotly.newPlot("level-plot", traces, layout({
    hovermode: "closest", margin: { l: 64, r: 20, t: 40, b: 44 }, xaxis: { ...axis(sides[0]), domain: sides.length === 1 ? [0, 1] : [0, 0.56] }, xaxis2: { ...axis(false), domain: [0.64, 1], visible: sides.length > 1 },
    yaxis: { tickvals: joints.map((_, i) => i), ticktext: joints.map((j) => literal(data.joints[j].name)), range: [joints.length - 0.4, -0.6], tickfont: { size: 12 }, fixedrange: true, zeroline: false },
  }), CONFIG);
  $("level-plot").on("plotly_click", (event) => { choose(event.points[0].customdata); $("curves").scrollIntoView({ block: "start" }); });
}

function startNoise() {
  if (!noise) return;
  $("noise").hidden = false;
  for (const line of noise.lines) {
    const label = line.slice(0, 11).trim(), item = element("li", "");
    if (!label || label === "noise") continue;  // the cards tell it
    item.append(element("b", label), ` ${line.slice(11)}`);
    $("noise-lines").append(item);
  }
  const kinds = Object.keys(noise.kinds).filter((kind) => noise.artefacts.some((row) => row.kind === kind));
  for (const kind of kinds) $("kind").append(element("option", `${kind} (${whole(noise.artefacts.filter((row) => row.kind === kind).length)})`, { value: kind }));
  $("kind").addEventListener("change", fillArtefacts);
  $("artefact-order").addEventListener("change", fillArtefacts);
  fillArtefacts();
  if (!spectra) $("spectrum").hidden = true;
  if (noise.channels.some((row) => row)) showLevels();
  else $("levels").hidden = true;
}
