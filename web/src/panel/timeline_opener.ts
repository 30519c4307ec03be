// The button of the timeline, which is loaded with its first press.
import { button } from "./dom";
import { noticeError } from "./notices";
import type { Timeline, TimelineHost } from "./timeline";

export function bindTimeline(host: TimelineHost): void {
  let timeline: Promise<Timeline> | null = null;
  button("timeline-open").onclick = () => {
    if (timeline) return void timeline.then((there) => there.toggle());
    timeline = import("./timeline").then((loaded) => new loaded.Timeline(host));
    timeline.catch((error: Error) => {
      timeline = null;
      noticeError("The timeline could not be loaded", error);
    });
  };
}
