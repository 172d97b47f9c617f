// The letters, their history, the address, and what can be taken away. `picture`, below, is what the letters drive:
// {fields, controls(), start(), change(moving), save(done), letters(part)}; `formulas` are functions of the letters.
const data = JSON.parse(document.getElementById("data").textContent);
const design = window.design = Object.assign({samples: 16}, window.design);
const byId = id => document.getElementById(id);
const say = text => { byId("message").textContent = text; };
const clamped = (value, low, high) => Math.min(Math.max(value, low), high);

function made(tag, properties = {}, ...children) {
  const one = document.createElement(tag);
  for (const [name, value] of Object.entries(properties))
    name.includes("-") || name === "role" ? one.setAttribute(name, value) : one[name] = value;
  one.append(...children);
  return one;
}

// Letters: their values in float64, in the order of the model.
const values = design.values = data.letters.map(letter => letter.value);
const rows = [];
const past = [], future = [];
let kept = [...values];

function show() {
  for (const row of rows) row.show();
  byId("undo").disabled = !past.length;
  byId("redo").disabled = !future.length;
  remember();
}

function commit() {
  if (values.some((value, k) => value !== kept[k])) {
    past.push(kept);
    future.length = 0;
    kept = [...values];
  }
  show();
  picture.change(false);
}

function travel(from, to) {
  if (!from.length) return;
  to.push(kept);
  kept = from.pop();
  kept.forEach((value, k) => { values[k] = value; });
  show();
  picture.change(false);
}

function put(k, value) {
  const {low, high} = data.letters[k];
  if (Number.isFinite(value)) values[k] = clamped(value, low, high);
}

function rowOf(letter, k) {
  const span = letter.high - letter.low, step = 10 ** Math.floor(Math.log10(span / 200));
  const id = `letter-${k}`, name = letter.unit ? `${letter.name} [${letter.unit}]` : letter.name;
  const slider = made("input", {type: "range", id, min: letter.low, max: letter.high, step, "aria-describedby": `${id}-doc`});
  const number = made("input", {type: "number", min: letter.low, max: letter.high, step: "any", "aria-label": `${letter.name}, value`});
  const label = made("label", {htmlFor: id, title: "double click: the value of the model"}, name);
  const row = made("div", {className: "letter"}, label, slider, number, made("small", {id: `${id}-doc`}, letter.doc));
  row.show = () => {
    slider.value = values[k];
    number.value = +values[k].toPrecision(12);
    row.classList.toggle("changed", values[k] !== letter.value);
  };
  slider.addEventListener("input", () => {
    put(k, +slider.value);
    number.value = slider.value;
    picture.change(true);
  });
  slider.addEventListener("change", commit);
  number.addEventListener("change", () => {
    if (number.value !== "") put(k, +number.value);
    commit();
  });
  label.addEventListener("dblclick", () => {
    put(k, letter.value);
    commit();
  });
  row.number = k;
  return row;
}

function fillPanel() {
  const groups = new Map();
  data.letters.forEach((letter, k) => {
    const row = rowOf(letter, k);
    rows.push(row);
    if (!groups.has(letter.group)) groups.set(letter.group, []);
    groups.get(letter.group).push(row);
  });
  let first = true;
  for (const [name, members] of groups) {
    const summary = made("summary", {}, `${name || "letters"} (${members.length})`);
    byId("panel").append(made("details", {open: first || rows.length <= 12}, summary, ...members));
    first = false;
  }
  if (!rows.length) byId("panel").append(made("p", {}, "This model has no letters."));
  // The wheel scrolls, it never changes a number.
  byId("panel").addEventListener("wheel", event => event.target.matches("input") && event.target.blur());
}

// A part is what a click names: the letters that its leaves depend on stay.
function choose(part) {
  const members = data.parts[part]?.letters, groups = [...byId("panel").querySelectorAll("details")];
  for (const row of rows) row.hidden = Boolean(members) && !members.includes(row.number);
  for (const group of groups) {
    group.hidden = ![...group.querySelectorAll(".letter")].some(row => !row.hidden);
    if (members) group.open = true;
  }
  byId("only").hidden = !members;
  byId("which").textContent = members ? `${part}${members.length ? "" : ": no letters"}` : "";
}

function fillLegend() {
  for (const [name, {colour}] of Object.entries(data.parts)) {
    const patch = made("i", {"aria-hidden": "true"});
    patch.style.background = colour;
    const button = made("button", {title: "its letters"}, patch, name);
    button.addEventListener("click", () => choose(name));
    byId("legend").append(made("li", {}, button));
  }
}

// The address: letters by name and the view by ~name, numbers alone; whatever is none of these is ignored.
const view = design.view = {};
let waiting = 0;

function readAddress() {
  for (const [name, field] of Object.entries(picture.fields)) view[name] = field.value;
  data.letters.forEach((letter, k) => { values[k] = letter.value; });
  const places = new Map(data.letters.map((letter, k) => [letter.name, k]));
  for (const [key, text] of new URLSearchParams(location.hash.slice(1))) {
    const value = text.trim() === "" ? NaN : Number(text);
    const field = key.startsWith("~") && Object.hasOwn(picture.fields, key.slice(1)) && picture.fields[key.slice(1)];
    if (!Number.isFinite(value)) continue;
    if (field) view[key.slice(1)] = clamped(field.whole ? Math.round(value) : value, field.low, field.high);
    else if (places.has(key)) put(places.get(key), value);
  }
  kept = [...values];
}

function remember() {
  clearTimeout(waiting);
  waiting = setTimeout(() => {
    const words = new URLSearchParams();
    data.letters.forEach((letter, k) => values[k] !== letter.value && words.set(letter.name, values[k]));
    for (const [name, field] of Object.entries(picture.fields))
      if (view[name] !== field.value) words.set(`~${name}`, +view[name].toPrecision(6));
    const text = String(words);
    try {
      history.replaceState(null, "", text ? `#${text}` : location.pathname + location.search);
    } catch { /* a page inside another one has no address of its own */ }
  }, 120);
}

// A choice or a number of the view as a control of the header.
function choice(name, label, options) {
  const select = made("select", {}, ...options.map((text, k) => made("option", {value: k}, text)));
  select.value = view[name];
  select.addEventListener("change", () => change({[name]: +select.value}));
  select.show = () => { select.value = view[name]; };
  return made("label", {}, `${label} `, select);
}

function change(parts, moving = false) {
  Object.assign(view, parts);
  for (const control of byId("controls").querySelectorAll("select, input")) control.show?.();
  remember();
  picture.change(moving);
}

// What is taken away: files of the browser, and what Python answers or would, with the command to type.
function download(name, blob) {
  const link = made("a", {href: URL.createObjectURL(blob), download: name});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

function answer(title, note, text) {
  byId("answer-title").textContent = title;
  byId("answer-note").textContent = note;
  byId("answer-text").textContent = text;
  if (!byId("answer").open) byId("answer").showModal();
}

function command(pattern) {
  const changed = data.letters.map((letter, k) => [letter.name, values[k], letter.value]).filter(([, value, given]) => value !== given);
  const quoted = text => /^[\w.=+-]+$/.test(text) ? text : `'${text.replaceAll("'", `'\\''`)}'`;
  const words = data.python
    ? `{${changed.map(([name, value]) => `${JSON.stringify(name)}: ${value}`).join(", ")}}`
    : changed.map(([name, value]) => ` --set ${quoted(`${name}=${value}`)}`).join("");
  return pattern.replace("{letters}", () => words);
}

const letters = () => Object.fromEntries(data.letters.map((letter, k) => [letter.name, values[k]]));

async function ask(path) {
  const reply = await fetch(path, {method: "POST", headers: {"Content-Type": "application/json"}, body: JSON.stringify(letters())});
  if (!reply.ok) throw new Error(await reply.text());
  return reply;
}

async function take(service, button) {
  if (!data.served) {
    answer(service.title, `${service.says} Type:`, command(service.command));
    return;
  }
  button.disabled = true;
  say(`${service.title} ...`);
  try {
    const reply = await ask(service.path);
    if (service.path.includes(".")) download(service.path, await reply.blob());
    else answer(service.title, command(service.command), await reply.text());
    say(decodeURIComponent(reply.headers.get("X-Status")));
  } catch (error) {
    say("");
    answer(service.title, "Not done:", error.message);
  }
  button.disabled = false;
}

function fillHeader() {
  byId("undo").addEventListener("click", () => travel(past, future));
  byId("redo").addEventListener("click", () => travel(future, past));
  byId("reset").addEventListener("click", () => {
    data.letters.forEach((letter, k) => put(k, letter.value));
    commit();
  });
  byId("all").addEventListener("click", () => choose(null));
  byId("save-picture").addEventListener("click", () => picture.save(blob => blob && download(`${data.title}.png`, blob)));
  byId("save-letters").addEventListener("click", () => {
    download("letters.json", new Blob([`${JSON.stringify(letters(), null, 2)}\n`], {type: "application/json"}));
  });
  byId("copy").addEventListener("click", () => navigator.clipboard?.writeText(byId("answer-text").textContent));
  for (const service of data.services) {
    const button = made("button", {}, service.title);
    button.addEventListener("click", () => take(service, button));
    byId("away").append(button);
  }
  addEventListener("keydown", event => {
    const key = event.key.toLowerCase();
    if (!(event.ctrlKey || event.metaKey) || event.target.matches("input[type=number]")) return;
    if (key !== "z" && key !== "y") return;
    event.preventDefault();
    key === "y" || event.shiftKey ? travel(future, past) : travel(past, future);
  });
}

// Drag turns or moves; with the right button, with shift or with two fingers it moves; wheel and pinch zoom.
function listen(canvas, {drag, move, zoom, point, press, reset}) {
  const fingers = new Map();
  let still = null;
  const spread = () => {
    const [one, two] = fingers.values();
    return Math.hypot(one.clientX - two.clientX, one.clientY - two.clientY);
  };
  const at = event => {
    const box = canvas.getBoundingClientRect();
    return [(event.clientX - box.left) / box.width, 1 - (event.clientY - box.top) / box.height];
  };
  canvas.addEventListener("pointerdown", event => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, event);
    still = fingers.size === 1 && event.button === 0 ? event : null;
  });
  canvas.addEventListener("pointermove", event => {
    const last = fingers.get(event.pointerId);
    if (!last) {
      point(at(event));
      return;
    }
    const before = fingers.size === 2 && spread();
    fingers.set(event.pointerId, event);
    if (still && Math.hypot(event.clientX - still.clientX, event.clientY - still.clientY) > 4) still = null;
    const step = [event.clientX - last.clientX, event.clientY - last.clientY];
    if (before) {
      zoom(spread() / before, at(event));
      move(step[0] / 2, step[1] / 2);
    } else (event.buttons & 2 || event.shiftKey ? move : drag)(...step);
  });
  for (const end of ["pointerup", "pointercancel"])
    canvas.addEventListener(end, event => {
      fingers.delete(event.pointerId);
      if (end === "pointerup" && still) press(at(event));
      still = null;
    });
  canvas.addEventListener("pointerleave", () => point(null));
  canvas.addEventListener("wheel", event => {
    event.preventDefault();
    zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)), at(event));
  }, {passive: false});
  canvas.addEventListener("contextmenu", event => event.preventDefault());
  canvas.addEventListener("dblclick", reset);
  canvas.addEventListener("keydown", event => {
    const step = {ArrowLeft: [15, 0], ArrowRight: [-15, 0], ArrowUp: [0, 15], ArrowDown: [0, -15]}[event.key];
    const factor = {"+": 1.2, "=": 1.2, "-": 1 / 1.2}[event.key];
    if (event.ctrlKey || event.metaKey || !(step || factor || event.key === "Home")) return;
    event.preventDefault();
    if (step) (event.shiftKey ? move : drag)(...step);
    else if (factor) zoom(factor, [0.5, 0.5]);
    else reset();
  });
}

document.addEventListener("DOMContentLoaded", () => {
  readAddress();
  fillPanel();
  fillLegend();
  fillHeader();
  byId("controls").append(...picture.controls());
  show();
  picture.start();
  addEventListener("hashchange", () => {
    readAddress();
    show();
    change({});
  });
});
