// The report as text and pictures: folded while the page moves, whole on paper.

/** Folds it; from then on it unfolds where the page is printed. */
export function foldStill() {
  const parts = document.querySelectorAll("details.still");
  for (const part of parts) part.open = false;
  addEventListener("beforeprint", () => {
    for (const part of parts) part.open = true;
  });
}
