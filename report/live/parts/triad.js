// Three arrows with letters in the corner of a view: where its axes point.

import { colour } from "./theme.js";
import { element } from "./elements.js";

const SIZE = 76, REACH = 24;  // CSS pixels: of the corner, of an arrow

/** Keeps the arrows of a View3D as its camera turns; names: of the axes of its scene. */
export function showTriad(view, names = ["X", "Y", "Z"]) {
  const canvas = element("canvas", { class: "triad", role: "img",
    "aria-label": `directions of ${names.join(", ")}` });
  view.canvas.after(canvas);
  const draw = () => {
    const ratio = window.devicePixelRatio || 1, c = canvas.getContext("2d");
    [canvas.width, canvas.height] = [SIZE * ratio, SIZE * ratio];
    c.setTransform(ratio, 0, 0, ratio, SIZE * ratio / 2, SIZE * ratio / 2);
    c.font = "bold 12px system-ui, 'Segoe UI', Arial, sans-serif";
    c.textAlign = "center";
    c.textBaseline = "middle";
    c.lineWidth = 1.5;
    c.strokeStyle = colour("soft");
    c.fillStyle = colour("ink");
    const { right, up } = view.camera.axes();
    names.forEach((name, k) => {
      const [x, y] = [REACH * right[k], -REACH * up[k]];
      c.beginPath();
      c.moveTo(0, 0);
      c.lineTo(x, y);
      c.stroke();
      const size = Math.hypot(x, y) || 1;
      c.fillText(name, x + 9 * x / size, y + 9 * y / size);
    });
  };
  const before = view.afterDraw;
  view.afterDraw = () => {
    before();
    draw();
  };
}
