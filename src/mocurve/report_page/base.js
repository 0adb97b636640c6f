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
  } else if (!noise) {
    cards.push([whole(r.keys), `samples, against ${whole(r.samples)} in the first clip`]);
  }
  if (noise) cards.push(...noiseCards());
  const world = mm === null ? [three(r.max_error_world), "units"] : [three(length(r.max_error_world)), "mm"];
  const guess = data.guess ? `; about ${three(r.max_error_world * data.guess.millimetres)} mm if the length unit is what the body's height suggests, ${data.guess.name}` : "";
  cards.push([`${world[0]} ${world[1]}`, `is the furthest that any joint ${cleaning ? "was moved" : "is off"} in space${mm === null ? guess : `; ${three(r.max_error_world)} in the file's unit`}`]);
  if (r.max_error_degrees !== null) cards.push([`${three(r.max_error_degrees)}°`, `is the furthest that any rotation channel ${cleaning ? "was moved" : "is off"}; RMS ${three(r.rms_error_degrees)}°`]);
  if (r.over_bound !== null) cards.push([`${r.over_bound.toFixed(2)}×`, `the proven least: ${whole(r.lower_bound)} keys are needed at this tolerance`]);
  if (r.feet) cards.push([`${r.feet.after.speed.toFixed(2)} cm/s`, `is how fast feet slide where they stand in the first clip; there they do at ${r.feet.before.speed.toFixed(2)}`]);
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
