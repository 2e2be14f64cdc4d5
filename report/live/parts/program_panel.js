// A program that is played: buttons, clock, its text with the line that runs, what a touch finds.

import { element } from "./elements.js";
import { digits, fixed, signed } from "./numbers.js";

const AROUND = 3;  // lines of the program before and behind the one that runs

function clock(seconds) {
  const whole = Math.floor(seconds), two = v => String(v).padStart(2, "0");
  return `${Math.floor(whole / 3600)}:${two(Math.floor(whole / 60) % 60)}:${two(whole % 60)}`;
}

export class ProgramPanel {
  /** moved(time): called with every new time, s. */
  constructor(place, player, program, axes, moved) {
    Object.assign(this, { player, program, axes, moved, time: 0, isPlaying: false, before: null });
    this.texts = program.texts.map(text => text.split("\n"));
    const button = (text, label, onclick) => element("button", { type: "button", text,
      "aria-label": label, title: label, onclick });
    const isTouch = row => Boolean(program.touch && program.touch.values[row]);
    const isStop = row => (program.touch ? isTouch(row)
      : row === 0 || program.line.values[row] !== program.line.values[row - 1]);
    const what = program.touch ? "touch" : "line";
    this.play = button("play", "play the program", () => this.toggle());
    this.speed = element("select", { "aria-label": "speed" },
      ...[1, 5, 20, 100, 400].map(v => element("option", { text: `× ${v}`, value: v })));
    this.speed.value = 20;
    this.when = element("input", { type: "range", min: 0, max: player.last, step: "any", value: 0,
      "aria-label": "time of the program", oninput: () => {
        this.stop();
        this.go(Number(this.when.value));
      } });
    this.reading = element("output", { class: "clock" });
    this.found = element("p", { class: "found" });
    this.text = element("ol", { class: "program", "aria-label": "program" });
    const step = way => {
      this.stop();
      this.go(player.next(this.time, way, isStop));
    };
    place.append(element("div", { class: "row" },
      button("◀", `${what} before`, () => step(-1)), this.play,
      button("▶", `next ${what}`, () => step(1)), this.speed, this.when, this.reading),
    this.found, this.text);
  }

  toggle() {
    if (this.isPlaying) {
      this.stop();
      return;
    }
    if (this.time >= this.player.last) this.time = 0;
    this.isPlaying = true;
    this.before = null;
    this.play.textContent = "stop";
    requestAnimationFrame(stamp => this.tick(stamp));
  }

  stop() {
    this.isPlaying = false;
    this.play.textContent = "play";
  }

  tick(stamp) {
    if (!this.isPlaying) return;
    const gone = this.before === null ? 0 : (stamp - this.before) / 1000;
    this.before = stamp;
    this.go(Math.min(this.player.last, this.time + gone * Number(this.speed.value)));
    if (this.time >= this.player.last) this.stop();
    else requestAnimationFrame(next => this.tick(next));
  }

  go(time) {
    this.time = Math.min(Math.max(0, time), this.player.last);
    this.when.value = this.time;
    this.when.setAttribute("aria-valuetext", clock(this.time));
    this.moved(this.time);
  }

  /** Shows line, clock, touch; deviation: of the tool point, table frame, mm. */
  update(state, deviation) {
    const { program } = this, { row } = state;
    if (row < 0) return;
    const which = program.which.values[row], line = program.line.values[row];
    const block = this.block(which, line), place = block ? `block ${block[0]}` : `line ${line}`;
    this.reading.textContent = `${clock(this.time)}  ${program.names[which]}, ${place}`;
    this.found.textContent = this.findings(row, deviation);
    this.list(which, line);
  }

  findings(row, deviation) {
    const { program } = this, said = [], um = v => 1000 * v;
    const number = program.touch ? program.touch.values[row] : 0;
    if (number) {
      const which = program.which.values[row], feature = program.features[which][number];
      said.push(`touch ${number}${feature ? ` on ${feature}` : ""}`);
      if (program.normal) {
        const n = program.normal.values.subarray(3 * row, 3 * row + 3);
        const along = n[0] * deviation[0] + n[1] * deviation[1] + n[2] * deviation[2];
        said.push(`measured deviation ${signed(-um(along))} µm along the normal`);
      }
    }
    said.push(`deviation of the tool point ${digits(um(Math.hypot(...deviation)))} µm`);
    if (program.clearance && Number.isFinite(program.clearance.values[row])) {
      const body = program.nearest[program.nearest_body.values[row]];
      said.push(`clearance ${fixed(program.clearance.values[row], 1)} mm to ${body}`);
    }
    return said.join("; ");
  }

  /** The number that a line begins with, as in Klartext, where the control shows no other. */
  block(which, line) { return /^\d+(?= )/.exec(this.texts[which]?.[line - 1] ?? ""); }

  list(which, line) {
    const lines = this.texts[which];
    if (!lines || this.listed === `${which}:${line}`) return;
    this.listed = `${which}:${line}`;
    const first = Math.max(0, line - 1 - AROUND), last = Math.min(lines.length, line + AROUND);
    this.text.start = first + 1;
    this.text.style.listStyle = this.block(which, line) ? "none" : "";
    this.text.replaceChildren(...lines.slice(first, last).map((text, k) => element("li", {
      text: text || " ", class: first + k + 1 === line ? "now" : null,
      "aria-current": first + k + 1 === line ? "step" : null })));
  }
}
