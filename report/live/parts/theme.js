// Light and dark: colours of a page as its style sheet has them, and the switch between them.

/** A colour of the style sheet: colour("ink") is the value of --ink. */
export function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

export function isDark() {
  const asked = document.documentElement.dataset.theme;
  if (asked) return asked === "dark";
  return matchMedia("(prefers-color-scheme: dark)").matches;
}

/** A button that changes between light and dark; `changed` is called after every change. */
export function themeButton(button, changed) {
  const shown = () => {
    button.textContent = isDark() ? "light" : "dark";
    button.setAttribute("aria-label", `change to ${button.textContent} colours`);
    changed();
  };
  button.addEventListener("click", () => {
    document.documentElement.dataset.theme = isDark() ? "light" : "dark";
    shown();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", shown);
  // paper is white
  let before;
  addEventListener("beforeprint", () => {
    before = document.documentElement.dataset.theme;
    document.documentElement.dataset.theme = "light";
    changed();
  });
  addEventListener("afterprint", () => {
    if (before) document.documentElement.dataset.theme = before;
    else delete document.documentElement.dataset.theme;
    changed();
  });
  shown();
}

/** Three bytes for each value between -limit and limit: blue inside, grey nothing, orange outside. */
export function signedColours(values, limit, out = new Uint8Array(3 * values.length)) {
  const [low, none, high] = (isDark()
    ? ["#4aa3ff", "#8b929c", "#ff9d3c"] : ["#0072b2", "#b4bac2", "#d55e00"]).map(bytes);
  for (let i = 0; i < values.length; i++) {
    const share = Math.max(-1, Math.min(1, values[i] / limit)), end = share < 0 ? low : high;
    const s = Math.abs(share);
    for (let k = 0; k < 3; k++) out[3 * i + k] = none[k] + s * (end[k] - none[k]);
  }
  return out;
}

/** Three bytes for each value from low to high: dark violet, green, yellow (viridis). */
export function scaleColours(values, low, high, out = new Uint8Array(3 * values.length)) {
  const span = high - low || 1;
  for (let i = 0; i < values.length; i++) {
    const place = Math.max(0, Math.min(0.9999, (values[i] - low) / span)) * (SCALE.length - 1);
    const k = Math.floor(place), share = place - k;
    for (let c = 0; c < 3; c++) {
      out[3 * i + c] = SCALE[k][c] + share * (SCALE[k + 1][c] - SCALE[k][c]);
    }
  }
  return out;
}

export function bytes(hex) {
  return [1, 3, 5].map(k => parseInt(hex.slice(k, k + 2), 16));
}

const SCALE = ["#440154", "#46327e", "#365c8d", "#277f8e", "#1fa187", "#4ac16d", "#a0da39",
  "#fde725"].map(bytes);
