// Asks for the pairs that contact keeps apart, a few times a second while they are shown, and draws them.
import { contactsText, followPairs, gapColour, pairsOf, type ContactPairs, type ContactsAnswer } from "./contact_pairs";
import { ThickLines } from "./lines";
import type { ShownPlaces } from "./shown_places";

const mostPairs = 1000;
const every = 250; // [ms] from an answer to the next question
const everyAtRest = 1000; // the same while the session stands still

export interface ContactsHost {
  ask(most: number): Promise<ContactsAnswer>;
  arrived(): void; ///< there is an answer, or a refusal, to be shown
}

export class ContactsView {
  text = "";
  private readonly lines = new ThickLines(mostPairs, 5);
  readonly object = this.lines.object;
  private answer: ContactsAnswer | null = null;
  private pairs: ContactPairs | null = null;
  private timer = 0;
  private asking = false; // an answer is on its way
  private wanted = false;

  constructor(private readonly host: ContactsHost) {}

  /// Asks from now on, or no longer.
  want(wanted: boolean): void {
    if (wanted === this.wanted) return;
    this.wanted = wanted;
    clearTimeout(this.timer);
    if (!wanted) this.forget("");
    else if (!this.asking) void this.ask();
  }

  private forget(text: string): void {
    this.answer = this.pairs = null;
    this.text = text;
    this.object.visible = false;
  }

  private async ask(): Promise<void> {
    let wait = every;
    if (!document.hidden) {
      this.asking = true;
      try {
        const answer = await this.host.ask(mostPairs);
        const still = answer.step === this.answer?.step && answer.revision === this.answer.revision;
        if (still) wait = everyAtRest;
        else if (this.wanted) this.take(answer);
      } catch (error) {
        wait = everyAtRest;
        if (this.wanted) this.forget((error as Error).message);
        this.host.arrived();
      }
      this.asking = false;
    }
    if (this.wanted) this.timer = window.setTimeout(() => void this.ask(), wait);
  }

  private take(answer: ContactsAnswer): void {
    this.answer = answer;
    this.pairs = pairsOf(answer);
    this.text = contactsText(answer, this.pairs);
    for (let i = 0; i < answer.count; ++i)
      this.lines.tone.set(gapColour((this.pairs.gap[i] as number) / (this.pairs.keep[i] as number)), 3 * i);
    this.host.arrived();
  }

  /// Draws the pairs where the frame has their vertices, if that is of the present.
  show({ places, frame }: ShownPlaces, live: boolean): void {
    const { pairs, answer } = this;
    const fits = answer?.topology_revision === frame?.header.topologyRevision;
    this.object.visible = live && fits && pairs !== null && pairs.count > 0;
    if (!this.object.visible || !pairs) return;
    followPairs(pairs, places, this.lines.from, this.lines.to);
    this.lines.draw(pairs.count);
  }

  resize(width: number, height: number): void {
    this.lines.resize(width, height);
  }
}
