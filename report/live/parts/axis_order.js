// The order in which the axes of a machine are listed.

/** Numbers of the programmed axes: linear ones first, by their letters. */
export function axisOrder(axes) {
  const rank = k => (axes[k].is_rotary ? "2" : "1") + axes[k].name;
  return axes.map((_, k) => k).filter(k => axes[k].is_programmed)
    .sort((a, b) => (rank(a) < rank(b) ? -1 : 1));
}
