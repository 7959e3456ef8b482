// Excerpts under the results of a search. Sphinx fetches the pages for them, which no browser does from disk; scripts
// it loads from there. So every page has its text in a script of its own, and only those that were found are loaded.
"use strict";

const searchTexts = new Map();

// Called by those scripts: the text of a page, in sections with their anchors.
const searchText = (page, text) => searchTexts.get(page).told(text);

// A page may be found at several of its sections, and is loaded once for all of them.
const loadText = (page, root) => {
  const one = {};
  one.text = new Promise((told) => (one.told = told));
  searchTexts.set(page, one);
  const script = document.createElement("script");
  script.src = `${root}_texts/${page}.js`;
  script.onerror = () => one.told("");
  document.body.appendChild(script);
};

window.fetch = async (url) => {
  const root = document.documentElement.dataset.content_root;
  const page = decodeURI(url).slice(root.length).replace(/\.html$/, "");
  if (!searchTexts.has(page)) loadText(page, root);
  return new Response(await searchTexts.get(page).text);
};
