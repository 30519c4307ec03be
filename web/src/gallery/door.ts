// The way to the gallery, which is loaded when somebody opens it.
import type { GalleryHost } from "./index";
import { lateStyle } from "../panel/late_style";
import { noticeError } from "../panel/notices";

export function openGallery(host: GalleryHost): void {
  Promise.all([import("./index"), lateStyle("gallery.css")]).then(
    ([gallery]) => gallery.openGallery(host),
    (error: Error) => noticeError("The gallery could not be opened", error),
  );
}
