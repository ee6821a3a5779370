// Texts of the page in the language of its reader: a gettext catalogue as JSON, message -> translation.

let catalogue = {};

/** Load the catalogue of the browser's languages; English texts stand for what it lacks. */
export async function loadTexts() {
  try {
    const answer = await fetch("texts");
    if (answer.ok) {
      const { language, texts } = await answer.json();
      catalogue = texts;
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
