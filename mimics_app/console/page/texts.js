// Texts of the page in the language of its reader: a gettext catalogue as JSON, message -> translation.

let catalogue = Object.create(null);
let plurals = Object.create(null);
let shapes = [];
let rules = new Intl.PluralRules("en");

const NUMBER = "[-+]?\\d+(?:\\.\\d+)?";
const OWN = ["code", "condition", "file", "folder"];
const WORDS = { undefined: ".+?", s: "[^,]+?" };
const DECIMAL = /(?<![\w./:-])([-+]?\d+)\.(\d+)(?![\w/]|\.\d)/g;

/** Load the catalogue of the browser's languages; English texts stand for what it lacks. */
export async function loadTexts() {
  try {
    const answer = await fetch("texts");
    if (answer.ok) {
      const { language, texts, plurals: forms } = await answer.json();
      Object.assign(catalogue, texts);
      Object.assign(plurals, forms);
      rules = new Intl.PluralRules(language);
      const keys = [...Object.keys(texts), ...Object.keys(forms)];
      shapes = keys.filter((key) => key.includes("{")).map(shapeOf).sort((a, b) => b.said - a.said);
      document.documentElement.lang = language;
    }
  } catch {
    catalogue = {};
  }
  for (const node of document.querySelectorAll("[data-text]")) node.textContent = t(node.textContent);
}

/** Mark a text for the catalogues that `t` is given elsewhere. */
export function mark(text) {
  return text;
}

/** Return a text in the reader's language, with {name} replaced by values. */
export function t(text, values = {}) {
  return (catalogue[text] || text).replace(/\{(\w+)\}/g, (_, name) => values[name] ?? "");
}

/** Return what the program says in English, filled with its values, in the reader's language (as language.py does). */
export function told(text) {
  if (shapes.length === 0) return text;
  return text.split(/(\n| · )/).map((part) => found(part) || listed(part) || part.replace(DECIMAL, "$1,$2")).join("");
}

function found(part) {
  return catalogue[part] || filled(part);
}

/** Return a list of texts all of which are found, else "". */
function listed(text) {
  const parts = text.split(", ");
  const own = parts.length > 1 ? parts.map(found) : [""];
  return own.every(Boolean) ? own.join(", ") : "";
}

function shapeOf(key) {
  const parts = key.split(/\{(\w+)(?::([^}]*))?\}/);
  const literals = parts.filter((_, i) => i % 3 === 0);
  const names = parts.filter((_, i) => i % 3 === 1);
  const values = parts.filter((_, i) => i % 3 === 2).map((form) => `(${WORDS[form] || NUMBER})`);
  const escaped = literals.map((literal) => literal.replace(/[.*+?^${}()|[\]\\]/g, "\\$&"));
  const pattern = new RegExp(`^${escaped.map((literal, i) => literal + (values[i] || "")).join("")}$`);
  return { pattern, names, forms: plurals[key] || [catalogue[key]], said: literals.join("").length };
}

function filled(text) {
  for (const { pattern, names, forms } of shapes) {
    const match = pattern.exec(text);
    if (!match) continue;
    const value = (name) => match[1 + names.indexOf(name)];
    const template = forms.length > 1 ? forms[formOf(value("n"), forms.length)] : forms[0];
    return template.replace(/\{(\w+)(?::[^}]*)?\}/g, (_, name) => (OWN.includes(name) ? value(name) : told(value(name))));
  }
  return "";
}

/** Return which of the forms a number has: those of gettext have the order of the categories of Unicode. */
function formOf(number, count) {
  const there = rules.resolvedOptions().pluralCategories;
  const order = ["one", "two", "few", "many", "other"].filter((category) => there.includes(category));
  return Math.min(order.indexOf(rules.select(Number(number))), count - 1);
}
