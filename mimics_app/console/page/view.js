// What a person reads of a session: texts, lamps, lists. Every text is set as text, never as markup.

import { mark, t, told } from "./texts.js";

const byId = (id) => document.getElementById(id);
const MOST_LINES = 200;

const TRIAL_STATES = {
  approach: mark("The robot drives to the start"), ready: mark("Ready to start"), travel: mark("The person acts"), finished: mark("Goal reached"),
  timeout: mark("Time is over"), aborted: mark("Broken off"), stopped: mark("Stopped"), rest: mark("Rest"), done: mark("The session is over"),
};
const SAFETY = {
  ACTIVE: [mark("Force on"), "calm"], READY: [mark("Ready"), "calm"], HOMED: [mark("Ready"), "calm"], INIT: [mark("Starting"), "warn"], OFF: [mark("Off"), "warn"],
  DEGRADED: [mark("Force paused"), "warn"], SAFE_STOP: [mark("STOPPED"), "bad"], E_STOP: [mark("STOPPED by hand"), "bad"],
};
const STAYS = new Set(["note", "mark"]);

/** Return a figure with a fixed number of digits; "–" where there is none. */
export function figure(value, digits = 1, unit = "") {
  return Number.isFinite(value) ? `${value.toFixed(digits)}${unit && ` ${unit}`}` : "–";
}

/** Show pairs of caption and value in a list of definitions; nodes are kept, so that a reader's place is too. */
export function showPairs(list, pairs) {
  while (list.children.length > pairs.length) list.lastElementChild.remove();
  pairs.forEach(([caption, value, tone = ""], i) => {
    let row = list.children[i];
    if (!row) {
      row = document.createElement("div");
      row.append(document.createElement("dt"), document.createElement("dd"));
      list.append(row);
    }
    setText(row.firstElementChild, caption);
    setText(row.lastElementChild, value);
    row.lastElementChild.className = tone;
  });
}

/** Set a text where it differs: a live region is then read out once. */
export function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

function lamp(id, text, tone) {
  setText(byId(id), text);
  byId(id).className = `lamp ${tone}`;
}

/** Show the connection to the page's server and to the session. */
export function showConnection(text, tone) {
  lamp("connection", text, tone);
}

/** Show a message across the page, quietly where it is none to act on; "" hides it. */
export function showAlarm(text, quiet = false) {
  byId("alarm").classList.toggle("quiet-news", quiet);
  setText(byId("alarm"), text);
  byId("alarm").hidden = !text;
}

/** Show which session is attached; null: none. */
export function showSession(card) {
  setText(byId("title"), card ? card.title : t("Operator's page"));
  const parts = card ? [card.device, card.participant && t("participant {code}", { code: card.participant }), card.folder] : [];
  setText(byId("subtitle"), parts.filter(Boolean).join(" · "));
  document.title = card ? `${card.title} – ${t("operator")}` : t("Operator's page");
  if (!card) lamp("safety", "", "");
  byId("log").replaceChildren();
  byId("trial-rows").replaceChildren();
}

/** Show who operates. */
export function showRoles(roles) {
  const others = roles.clients - 1;
  const who = roles.operates ? t("You operate") : roles.operator === null ? t("Nobody operates") : t("You view");
  lamp("role", others ? `${who} (+${others})` : who, roles.operates ? "calm" : "warn");
}

/** Show the state of the trial, of the force, and of recording and computer. */
export function showStatus(status) {
  const task = status.task;
  const state = task.paused ? t("Paused") : t(TRIAL_STATES[task.state] || task.state);
  setText(byId("trial-state"), task.trials ? `${state} – ${t("trial {n} of {all}", { n: task.trial, all: task.trials })}` : state);
  byId("trial-progress").value = task.progress;
  setText(byId("trial-message"), told(status.board.message));
  showPairs(byId("cards"), status.board.cards.map((card) => [told(card.label), told(card.text), toneOf(card.tone)]));
  const [words, tone] = SAFETY[status.safety.state] || [status.safety.state, ""];
  lamp("safety", t(words), tone);
  const latched = tone === "bad";
  const stop = status.safety.stop;
  const said = stop && { what: told(stop.what), advice: told(stop.advice) };
  showAlarm(latched ? said ? t("The force is off: {what}; {advice}", said) : t("The force is off.") : alarmOf(status));
  showPerson(status);
}

function alarmOf(status) {
  const lost = status.signals_lost.map((what) => t("Body signals are lost: {what}", { what }));
  return [status.device, status.recorder.problem, ...lost].filter(Boolean).join(" · ");
}

function toneOf(tone) {
  return { alarm: "bad", warn: "warn", calm: "calm" }[tone] || "";
}

function showPerson(status) {
  const { person, features } = status;
  const pairs = [];
  for (const name of [mark("arousal"), mark("valence"), mark("effort")]) {
    const estimate = person && person[name];
    pairs.push([t(name), estimate ? `${figure(estimate[0], 2)} ± ${figure(Math.sqrt(estimate[1]), 2)}` : t("unknown")]);
  }
  if (person && person.load) {
    pairs.push([t("load (too little, right, too much)"), person.load.map((share) => `${Math.round(100 * share)} %`).join(" / ")]);
  }
  if (features) {
    for (const [name, quality] of Object.entries(features.quality)) {
      pairs.push([t("quality of {signal}", { signal: name }), `${Math.round(100 * quality)} %`, quality < 0.5 ? "bad" : "calm"]);
    }
    for (const [name, value] of Object.entries(features.values)) pairs.push([name.replaceAll("_", " "), figure(value, 2)]);
  }
  showPairs(byId("person"), pairs);
}

/** Show the newest numbers of the loop. */
export function showNumbers(values, frameHz) {
  const signed = (value) => figure(1000 * value, 0);
  showPairs(byId("numbers"), [
    [t("force"), figure(values.force, 1, "N")],
    [t("force of the person"), figure(values.force_measured, 1, "N")],
    [t("speed"), figure(100 * values.speed, 1, "cm/s")],
    [t("from the path"), figure(1000 * values.distance, 1, "mm")],
    [t("contact"), values.penetration > 0 || values.touching > 0 ? t("{mm} mm deep", { mm: figure(1000 * Math.max(values.penetration, values.depth), 1) }) : t("none")],
    [t("position"), `${signed(values.x)}, ${signed(values.y)}, ${signed(values.z)} mm`],
    [t("stability margin"), Number.isFinite(values.margin) && values.margin < 1e6 ? figure(values.margin, 2) : t("large"), values.margin < 0 ? "bad" : ""],
    [t("stiffness rendered"), figure(100 * values.stiffness_share, 0, "%")],
  ]);
  document.documentElement.dataset.hz = frameHz.toFixed(1);
}

/** Show the figures of computer and recording. */
export function showMachine(values, status, frameHz) {
  const loop = status.loop;
  showPairs(byId("machine-numbers"), [
    [t("session time"), figure(values.t_s, 0, "s")],
    [t("late ticks"), `${values.missed} ${t("of")} ${values.ticks}`, values.missed > values.ticks * 0.01 ? "warn" : ""],
    [t("lateness, median"), figure(loop.p50_us, 0, "µs")],
    [t("lateness, 99 %"), figure(loop.p99_us, 0, "µs")],
    [t("lateness, largest"), figure(loop.max_us / 1000, 1, "ms")],
    [t("work of a tick"), figure(values.duration_us, 0, "µs")],
    [t("scheduling"), loop.recipe],
    [t("stops, holds"), `${values.stops}, ${values.holds}`],
    [t("recording"), status.recorder.problem || t("writes"), status.recorder.problem ? "bad" : "calm"],
    [t("lost lines"), `${status.recorder.dropped}`, status.recorder.dropped ? "bad" : ""],
    [t("this page"), figure(frameHz, 0, "Hz")],
  ]);
}

/** Add finished trials to their list, the newest first. */
export function addTrials(entries) {
  for (const trial of entries) {
    const row = document.createElement("tr");
    const number = trial.practice ? t("practice") : `${trial.trial}`;
    for (const text of [number, t(trial.outcome), figure(trial.seconds, 1, "s"), figure(trial.score, 0), told(trial.happened || trial.cause || "")]) {
      const cell = document.createElement("td");
      cell.textContent = text;
      row.append(cell);
    }
    byId("trial-rows").prepend(row);
  }
  keepNewest(byId("trial-rows"));
}

/** Add lines of the journal to the log, the newest first; the oldest are dropped. */
export function addEvents(entries, startNs) {
  for (const entry of entries) {
    const line = document.createElement("li");
    const time = document.createElement("time");
    time.textContent = clockTime((entry.t_ns - startNs) / 1e9);
    const text = document.createElement("span");
    text.textContent = sayEvent(entry);
    line.append(time, text);
    byId("log").prepend(line);
  }
  keepNewest(byId("log"));
}

function keepNewest(list) {
  while (list.children.length > MOST_LINES) list.lastElementChild.remove();
}

function clockTime(seconds) {
  const whole = Math.max(0, Math.floor(seconds));
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}

function sayEvent({ kind, what }) {
  if (kind === "report") return what;
  if (kind === "command") {
    const values = Object.values(what.values || {}).join(" ");
    const said = `${t((what.command || "").replaceAll("_", " "))} ${values}`.trim();
    const from = STAYS.has(what.command) ? "" : ` (${what.who})`;
    return what.done ? `${said}${from}${what.why ? `: ${what.why}` : ""}` : t("refused: {said}: {why}", { said, why: what.why });
  }
  if (kind === "state") return t(TRIAL_STATES[what.state] || what.state);
  if (kind === "pause") return what.on ? t("Paused") : t("Resumed");
  if (kind === "action") return `${t("new values")}: ${Object.entries(what.values).map(([name, value]) => `${name} ${figure(value, 2)}`).join(", ")}`;
  return `${kind.replaceAll("_", " ")}: ${Object.entries(what).filter(([name]) => name !== "t_ns").map(([name, value]) => `${name} ${typeof value === "object" ? JSON.stringify(value) : value}`).join(", ")}`;
}

/** Show a short message for some seconds. */
export function toast(text) {
  const line = document.createElement("p");
  line.textContent = text;
  byId("toasts").append(line);
  setTimeout(() => line.remove(), 5000);
}

/** Show a picture of the person, a JPEG. */
export function showPicture(bytes) {
  showJpeg(byId("picture-image"), bytes, t("what the person sees now"));
  byId("picture-none").hidden = true;
}

/** Show a picture of another view, a JPEG. */
export function showSecondPicture(bytes, name) {
  showJpeg(byId("second-image"), bytes, t("the scene now, from the view {name}", { name }));
}

/** Hide the pictures until new ones come. */
export function hidePictures() {
  for (const id of ["picture-image", "second-image"]) byId(id).hidden = true;
  byId("picture-none").hidden = false;
}

function showJpeg(image, bytes, alt) {
  const before = image.src;
  image.src = URL.createObjectURL(new Blob([bytes], { type: "image/jpeg" }));
  image.alt = alt;
  image.hidden = false;
  if (before) URL.revokeObjectURL(before);
}
