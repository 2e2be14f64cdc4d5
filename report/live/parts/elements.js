// Elements of a page: made in one call, with labels for readers of screens.

/** An element: name, attributes (`on...`: listeners; `text`: its text), children. */
export function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key === "text") made.textContent = value;
    else if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (value === true) made.setAttribute(key, "");
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(key, value);
  }
  made.append(...children.filter(child => child !== null));
  return made;
}

/**
 * A slider with its words and number. words(value): the number as it is said; input(value): called
 * while it moves. Its `set(value)` moves it and says nothing.
 */
export function slider({ label, low, high, value, step = "any", words = String, input }) {
  const reading = element("output", { text: words(value) });
  const range = element("input", {
    type: "range", min: low, max: high, step, value, "aria-label": label,
    "aria-valuetext": words(value),
  });
  const say = v => {
    reading.textContent = words(v);
    range.setAttribute("aria-valuetext", words(v));
  };
  range.addEventListener("input", () => {
    say(Number(range.value));
    input(Number(range.value));
  });
  const made = element("label", { class: "slider" },
    element("span", { text: label }), range, reading);
  made.set = v => {
    range.value = v;
    say(v);
  };
  made.range = range;
  return made;
}

/** A switch: a checkbox with its label. */
export function toggle({ label, value = false, changed }) {
  const box = element("input", { type: "checkbox", onchange: () => changed(box.checked) });
  box.checked = value;
  const made = element("label", { class: "toggle" }, box, element("span", { text: label }));
  made.set = v => { box.checked = v; };
  made.box = box;
  return made;
}

/** A table: heads; rows of text; numbers to the right. */
export function table(heads, rows, caption = "") {
  const cells = (kind, row) => row.map((text, k) => element(kind, {
    text, class: k && /^[+−<]?\s?\d/.test(text) ? "n" : null, scope: kind === "th" ? "col" : null,
  }));
  return element("table", {},
    caption ? element("caption", { text: caption }) : null,
    element("thead", {}, element("tr", {}, ...cells("th", heads))),
    element("tbody", {}, ...rows.map(row => element("tr", {}, ...cells("td", row)))));
}

/** Puts text on the clipboard, also on a page from a file. */
export async function copied(text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = element("textarea", { text, style: "position:fixed;opacity:0" });
    document.body.append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
  }
}
