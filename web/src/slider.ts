// A lil-gui controller with a native range input: reachable by keyboard, and able to spread its travel logarithmically.
import { Controller, type GUI } from "lil-gui";

export interface Scale {
  min: number;
  max: number;
  step?: number;   ///< of a linear scale
  log?: boolean;   ///< equal ratios take equal travel
  zero?: boolean;  ///< the left end of a logarithmic scale is 0
  unit?: string;
  whole?: boolean;
}

const travel = 1000;
const zeroEnd = 20;  // of the travel, where a logarithmic scale jumps to 0

function toValue(at: number, scale: Scale): number {
  if (!scale.log) {
    const step = scale.step ?? (scale.max - scale.min) / 200;
    const value = scale.min + ((scale.max - scale.min) * at) / travel;
    return Number((Math.round(value / step) * step).toPrecision(6));
  }
  const start = scale.zero ? zeroEnd : 0;
  if (scale.zero && at < start / 2) return 0;
  const share = Math.max(0, at - start) / (travel - start);
  const value = scale.min * (scale.max / scale.min) ** share;
  return scale.whole ? Math.round(value) : Number(value.toPrecision(3));
}

function toTravel(value: number, scale: Scale): number {
  if (!scale.log) return (travel * (value - scale.min)) / (scale.max - scale.min);
  if (value <= 0) return 0;
  const start = scale.zero ? zeroEnd : 0;
  return start + ((travel - start) * Math.log(value / scale.min)) / Math.log(scale.max / scale.min);
}

/// Short and exact enough to read: 20000, 0.001, 1e-5.
export function readable(value: number): string {
  return String(Number(value.toPrecision(5)));
}

export class SliderController extends Controller {
  private readonly range = document.createElement("input");
  private readonly text = document.createElement("input");

  constructor(gui: GUI, object: Record<string, unknown>, property: string, label: string, private readonly scale: Scale) {
    super(gui, object, property, "slider-controller");
    this.range.type = "range";
    this.range.min = "0";
    this.range.max = String(travel);
    this.range.step = "1";
    this.range.tabIndex = 0;
    this.text.type = "text";
    this.text.inputMode = "decimal";
    this.text.spellcheck = false;
    for (const input of [this.range, this.text]) input.setAttribute("aria-label", scale.unit ? `${label} [${scale.unit}]` : label);
    this.$widget.append(this.range, this.text);
    this.range.addEventListener("input", () => this.setValue(toValue(Number(this.range.value), this.scale)));
    this.range.addEventListener("change", () => this._callOnFinishChange());
    this.text.addEventListener("focus", () => this.text.select());
    this.text.addEventListener("blur", () => this.take());
    this.text.addEventListener("keydown", (event) => this.key(event));
    if (scale.unit) {
      const unit = document.createElement("span");
      unit.className = "unit";
      unit.textContent = scale.unit;
      this.name(label);
      this.$name.append(unit);
    } else {
      this.name(label);
    }
    this.updateDisplay();
  }

  override updateDisplay(): this {
    const value = Number(this.getValue());
    const at = Math.min(travel, Math.max(0, toTravel(value, this.scale)));
    if (Number(this.range.value) !== Math.round(at)) this.range.value = String(at);
    this.range.style.setProperty("--filled", `${at / (travel / 100)}%`);
    this.range.setAttribute("aria-valuetext", `${readable(value)} ${this.scale.unit ?? ""}`);
    if (document.activeElement !== this.text) this.text.value = readable(value);
    return this;
  }

  private key(event: KeyboardEvent): void {
    if (event.key === "Enter") this.text.blur();
    if (event.key === "Escape") {
      this.text.value = readable(Number(this.getValue()));
      this.text.blur();
    }
    const direction = event.key === "ArrowUp" ? 1 : event.key === "ArrowDown" ? -1 : 0;
    if (direction === 0) return;
    event.preventDefault();
    const at = toTravel(Number(this.getValue()), this.scale) + direction * (event.shiftKey ? 50 : 10);
    this.setValue(toValue(Math.min(travel, Math.max(0, at)), this.scale));
    this.text.value = readable(Number(this.getValue()));
    this._callOnFinishChange();
  }

  // A typed number may lie outside the slider's travel: the server has the last word.
  private take(): void {
    const typed = this.text.value.trim().replace(",", ".");
    const value = Number(typed);
    const changed = typed !== "" && Number.isFinite(value) && readable(value) !== readable(Number(this.getValue()));
    if (changed) {
      this.setValue(this.scale.whole ? Math.round(value) : value);
      this._callOnFinishChange();
    }
    this.text.value = readable(Number(this.getValue()));
  }
}
