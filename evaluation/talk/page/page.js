"use strict";

// Everything that is shown goes in as text: no sentence and no file can become a part of the page.

const $ = (id) => document.getElementById(id);
const MOST_BARS = 5, LEAST_BAR = 0.01, PAUSE = 150, MOST_HISTORY = 50;
const PLAY = 200; // ms between the pictures of a clip that is played again
const state = { robots: [], scene: null, seen: null, asked: 0, looked: 0, running: new Map(), draws: 0 };

function made(name, text = "", className = "") {
  const element = document.createElement(name);
  element.textContent = text;
  element.className = className;
  return element;
}

function drawn(name, attributes, text = "") {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.textContent = text;
  return element;
}

const percent = (share) => `${(100 * share).toFixed(share > 0 && share < 0.1 ? 1 : 0)} %`;

// What the server is asked.

class Refused extends Error {}

async function asked(path, question, signal) {
  const options = question === undefined ? {} : { method: "POST", body: JSON.stringify(question), signal };
  let answer;
  try {
    answer = await fetch(path, options);
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new Refused("The server has stopped. Start it again (make talk), then say it again.");
  }
  if (answer.ok) return answer;
  const text = await answer.text();
  let reason = text;
  try { reason = JSON.parse(text).error; } catch { /* it is plain text */ }
  throw new Refused(reason);
}

async function* lines(path, question, signal) {
  const reader = (await asked(path, question, signal)).body.pipeThrough(new TextDecoderStream()).getReader();
  let rest = "";
  try {
    for (;;) {
      const { value, done } = await reader.read();
      if (done) return;
      const parts = (rest + value).split("\n");
      rest = parts.pop();
      for (const part of parts) {
        const line = JSON.parse(part);
        if (line.error) throw new Refused(line.error);
        yield line;
      }
    }
  } catch (error) {
    if (error instanceof Refused || error.name === "AbortError") throw error;
    throw new Refused("The server has stopped. Start it again (make talk), then say it again.");
  }
}

function problem(error) {
  if (error.name === "AbortError") return;
  if (!(error instanceof Refused)) console.error(error);
  $("problem").textContent = error.message;
}

const calmly = (work) => (...given) => work(...given).then(undefined, problem);

// Who is there, and where.

const chosen = () => [$("robot"), $("other")].filter((one) => one.value !== "").map((one) => Number(one.value));

function option(value, text) {
  const element = made("option", text);
  element.value = value;
  return element;
}

function offerOthers() {
  const own = state.robots[Number($("robot").value)].experiment;
  const before = $("other").value;
  const others = state.robots.map((one, number) => [number, one]).filter(([, one]) => one.experiment === own);
  $("other").replaceChildren(option("", "nobody"), ...others.map(([number, one]) => option(number, one.label)));
  $("other").value = others.some(([number]) => String(number) === before) ? before : "";
}

async function meet() {
  const known = await (await asked("/robot", { robot: Number($("robot").value) })).json();
  $("words").replaceChildren(...Object.entries(known.words).map(([word, channel]) => {
    const button = made("button", word, channel || "");
    button.type = "button";
    button.title = channel ? `it takes it for a word of: ${channel}` : "every channel explains it";
    button.addEventListener("click", () => {
      $("sentence").value = `${$("sentence").value.trim()} ${word}`.trim();
      $("sentence").focus();
      understand();
    });
    return button;
  }));
  $("draw").hidden = !known.draws;
  const before = $("scene").value;
  const news = [...$("scene").options].filter((one) => known.draws && one.value.startsWith("new"));
  $("scene").replaceChildren(...known.scenes.map((number) => option(`old ${number}`, `scene ${number}`)), ...news);
  if ([...$("scene").options].some((one) => one.value === before)) $("scene").value = before;
  offerOthers();
}

async function look() {
  const [kind, number] = $("scene").value.split(" ");
  const scene = { number: Number(number), drawn: kind === "new" };
  const turn = ++state.looked;
  stopAll();
  $("status").textContent = scene.drawn ? "The scene is drawn …" : "";
  for await (const line of lines("/scene", { robot: Number($("robot").value), ...scene })) {
    if (turn !== state.looked) return;
    if (line.ahead > 0) $("status").textContent = `${line.ahead} before you …`;
    if (line.places) {
      state.scene = scene;
      state.seen = line;
      $("status").textContent = "";
      $("sentence").placeholder = line.said;
      $("robots").replaceChildren();
    }
  }
  await understood();
}

// What is understood.

async function understood() {
  const turn = ++state.asked, robots = chosen();
  if (!state.scene) return;
  const question = { robot: robots[0], other: robots[1] ?? null, sentence: $("sentence").value, ...state.scene };
  let heard;
  try {
    heard = (await (await asked("/hear", question)).json()).heard;
  } catch (error) {
    if (turn !== state.asked) return;
    for (const panel of $("robots").children) panel.classList.add("stale");
    allow();
    throw error;
  }
  if (turn !== state.asked) return;
  $("problem").textContent = "";
  while ($("robots").children.length > heard.length) $("robots").lastChild.remove();
  heard.forEach((one, place) => show(panel(place), one, robots[place]));
  const unknown = heard[0].unknown;
  $("status").textContent = heard[0].words.length === 0 ? "Nothing is said: any object is as good as it is common."
    : unknown.length ? `Unknown to it: ${unknown.join(", ")}` : "";
  allow();
}

let pause;
function understand() {
  clearTimeout(pause);
  pause = setTimeout(calmly(understood), PAUSE);
}

function panel(place) {
  const there = $("robots").children[place];
  if (there) return there;
  const one = $("panel").content.firstElementChild.cloneNode(true);
  one.querySelector(".act").addEventListener("click", calmly(() => act(one)));
  $("robots").append(one);
  return one;
}

function show(one, heard, robot) {
  if (one.dataset.robot !== String(robot)) stop(one);
  one.dataset.robot = robot;
  one.classList.remove("stale");
  one.querySelector("h2").textContent = heard.label;
  one.querySelector(".sentence").replaceChildren(...heard.words.map((word) => shownWord(word, heard.frames)));
  const sight = one.querySelector(".sight");
  sight.querySelector("svg")?.remove();
  sight.append(state.seen.image ? picture(heard) : map(heard));
  const best = [...heard.categories].sort((a, b) => b.probability - a.probability).slice(0, MOST_BARS)
    .filter((category, place) => place < 1 || category.probability >= LEAST_BAR);
  one.querySelector(".bars").replaceChildren(...best.map((category) => {
    const item = made("li"), bar = made("span", "", "bar"), filled = made("i");
    filled.style.width = `${100 * category.probability}%`;
    bar.append(filled);
    item.append(made("span", `${category.category} “${category.label}”`), bar, made("span", percent(category.probability)));
    return item;
  }));
}

function shownWord(word, frames) {
  const element = made("span", word.text, "word");
  let told = "unknown";
  if (word.known && word.channels) {
    const [channel, share] = Object.entries(word.channels).reduce((a, b) => (b[1] > a[1] ? b : a));
    element.classList.add(channel);
    told = `${channel} ${percent(share)}`;
  } else if (word.known) {
    told = frames ? "too many words" : "all channels";
  } else {
    element.classList.add("unknown");
  }
  element.append(made("small", told));
  return element;
}

function marked(svg, heard, at) {
  heard.objects.forEach((share, m) => {
    const is = heard.chosen.includes(m), [shape, x, y] = at(m);
    shape.setAttribute("class", is ? "box chosen" : "box");
    shape.setAttribute("stroke-width", 1.5 + 3 * share);
    shape.setAttribute("stroke-opacity", 0.35 + 0.65 * share);
    shape.dataset.object = m;
    svg.append(shape, drawn("text", { x, y, "text-anchor": "middle" }, `${m + 1}: ${percent(share)}${is ? " ✓" : ""}`));
  });
  const best = heard.chosen.map((m) => m + 1).join(" or ");
  svg.setAttribute("role", "img");
  svg.setAttribute("aria-label", `Objects from left to right: ${heard.objects.map(percent).join(", ")}. Meant: ${best}.`);
  return svg;
}

function picture(heard) {
  const [width, height] = state.seen.size;
  const svg = drawn("svg", { viewBox: `0 0 ${width} ${height}` });
  svg.append(drawn("image", { href: state.seen.image, width, height }));
  return marked(svg, heard, (m) => {
    const [left, top, right, bottom] = state.seen.boxes[m];
    const box = drawn("rect", { x: left - 3, y: top - 3, width: right - left + 6, height: bottom - top + 6, rx: 4 });
    const middle = Math.min(Math.max((left + right) / 2, 36), width - 36);
    return [box, middle, top > 20 ? top - 8 : bottom + 18];
  });
}

// Where there is no picture: places on the table from above, ahead of the robot up, to its left left.
function map(heard) {
  const svg = drawn("svg", { viewBox: "0 0 320 240" });
  const places = state.seen.places, range = (axis) => places.map((place) => place[axis]);
  const middle = (values) => (Math.max(...values) + Math.min(...values)) / 2;
  const [cx, cy] = [middle(range(0)), middle(range(1))];
  const wide = Math.max(...range(0).map((x) => Math.abs(x - cx)), ...range(1).map((y) => Math.abs(y - cy)), 1e-9);
  return marked(svg, heard, (m) => {
    const x = 160 - ((places[m][1] - cy) / wide) * 85, y = 125 - ((places[m][0] - cx) / wide) * 75;
    return [drawn("circle", { cx: x, cy: y, r: 14 }), x, y - 20];
  });
}

// What is done.

function allow() {
  const silent = $("sentence").value.trim() === "" || !state.seen;
  for (const one of $("robots").children) {
    const busy = state.running.has(one);
    const button = one.querySelector(".act");
    button.disabled = silent || busy || one.classList.contains("stale") || Boolean(state.seen.reason);
    if (state.seen?.reason) one.querySelector(".deed").textContent = state.seen.reason;
  }
  const first = $("robots").firstChild;
  $("do").disabled = !first || first.querySelector(".act").disabled;
}

function stop(one) {
  state.running.get(one)?.abort();
  state.running.delete(one);
  clearInterval(Number(one.dataset.clock));
}

function stopAll() {
  for (const one of [...state.running.keys()]) stop(one);
}

async function act(one) {
  stop(one);
  const control = new AbortController();
  state.running.set(one, control);
  const said = $("sentence").value.trim(), label = one.querySelector("h2").textContent;
  const clip = one.querySelector(".clip"), image = clip.querySelector("img"), bar = clip.querySelector("progress");
  const caption = clip.querySelector("figcaption"), deed = one.querySelector(".deed"), pictures = [];
  const scene = state.seen.name;
  deed.textContent = "";
  $("problem").textContent = "";
  clip.hidden = false;
  clip.dataset.pictures = 0;
  image.removeAttribute("src");
  bar.hidden = false;
  bar.removeAttribute("value");
  caption.textContent = "It begins …";
  allow();
  try {
    const question = { robot: Number(one.dataset.robot), sentence: said, ...state.scene };
    for await (const line of lines("/act", question, control.signal)) {
      if (line.ahead > 0) caption.textContent = `${line.ahead} before you …`;
      if (line.image) {
        caption.textContent = "What it does";
        image.src = line.image;
        bar.value = line.share;
        clip.dataset.pictures = pictures.push(line.image);
      }
      if (line.described) {
        const words = Object.values(line.described).join(" ");
        deed.textContent = `The tutor saw: ${line.tutor ?? "nothing"}. The robot says: ${words}.`;
        note(said, scene, label, line.attended + 1, line.tutor ?? "nothing", words);
        caption.textContent = "What it did";
        bar.hidden = true;
      }
    }
    again(one, image, pictures);
  } catch (error) {
    caption.textContent = "It broke off";
    bar.hidden = true;
    throw error;
  } finally {
    if (state.running.get(one) === control) state.running.delete(one);
    allow();
  }
}

function again(one, image, pictures) {
  if (matchMedia("(prefers-reduced-motion: reduce)").matches || pictures.length < 2) return;
  let place = 0;
  const rest = Math.ceil(1500 / PLAY);
  one.dataset.clock = setInterval(() => {
    place = (place + 1) % (pictures.length + rest);
    image.src = pictures[Math.min(place, pictures.length - 1)];
  }, PLAY);
}

function note(said, scene, label, object, tutor, words) {
  const item = made("li"), button = made("button", said);
  button.type = "button";
  button.title = "say it again";
  button.addEventListener("click", () => {
    $("sentence").value = said;
    $("sentence").focus();
    understand();
  });
  item.append(button, document.createTextNode(` ${scene}, object ${object}: ${tutor}; it says “${words}” — ${label}`));
  $("history").prepend(item);
  while ($("history").children.length > MOST_HISTORY) $("history").lastChild.remove();
}

async function begin() {
  const known = await (await asked("/robots")).json();
  state.robots = known.robots;
  $("robot").replaceChildren(...known.robots.map((one, number) => option(number, one.label)));
  $("robot").value = known.first;
  $("sentence").focus();
  await meet();
  await look();
}

$("robot").addEventListener("change", calmly(async () => { await meet(); await look(); }));
$("other").addEventListener("change", calmly(understood));
$("scene").addEventListener("change", calmly(look));
$("draw").addEventListener("click", calmly(async () => {
  // Another number each time, also after the page is loaded anew; the same number is the same scene.
  const number = 1 + Math.floor(Math.random() * 9999);
  $("scene").append(option(`new ${number}`, `draw ${number}`));
  $("scene").value = `new ${number}`;
  await look();
}));
$("sentence").addEventListener("input", () => { allow(); understand(); });
$("say").addEventListener("submit", (event) => {
  event.preventDefault();
  clearTimeout(pause);
  calmly(async () => {
    await understood();
    const first = $("robots").firstChild;
    if (!$("do").disabled) await act(first);
  })();
});
addEventListener("pagehide", stopAll);
calmly(begin)();
