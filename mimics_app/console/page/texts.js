// Texts of the page in the language of its reader: a gettext catalogue as JSON, message -> translation.

let catalogue = {};
let shapes = [];

const NUMBER = "[-+]?\\d+(?:\\.\\d+)?";
const WORDS = { undefined: ".+?", s: "[^,]+?" };
const DECIMAL = /(?<![\w./:-])([-+]?\d+)\.(\d+)(?![\w/]|\.\d)/g;

/** Load the catalogue of the browser's languages; English texts stand for what it lacks. */
export async function loadTexts() {
  try {
    const answer = await fetch("texts");
    if (answer.ok) {
      const { language, texts } = await answer.json();
      catalogue = texts;
      shapes = Object.keys(texts).filter((key) => key.includes("{")).map(shapeOf).sort((a, b) => b.said - a.said);
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
  return text.split(/(\n| · )/).map((part) => catalogue[part] || filled(part) || part.replace(DECIMAL, "$1,$2")).join("");
}

function shapeOf(key) {
  const parts = key.split(/\{(\w+)(?::([^}]*))?\}/);
  const literals = parts.filter((_, i) => i % 3 === 0);
  const names = parts.filter((_, i) => i % 3 === 1);
  const values = parts.filter((_, i) => i % 3 === 2).map((form) => `(${WORDS[form] || NUMBER})`);
  const escaped = literals.map((literal) => literal.replace(/[.*+?^${}()|[\]\\]/g, "\\$&"));
  const pattern = new RegExp(`^${escaped.map((literal, i) => literal + (values[i] || "")).join("")}$`);
  return { pattern, names, text: catalogue[key], said: literals.join("").length };
}

function filled(text) {
  for (const { pattern, names, text: template } of shapes) {
    const found = pattern.exec(text);
    if (found) return template.replace(/\{(\w+)(?::[^}]*)?\}/g, (_, name) => told(found[1 + names.indexOf(name)]));
  }
  return "";
}
