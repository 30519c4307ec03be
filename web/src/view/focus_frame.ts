// The frame around the picture: it says where the focus is to whoever came there by Tab. A key pressed after a click
// brings none: browsers would draw one (:focus-visible), around everything that is to be looked at.
export function bindFocusFrame(view: HTMLElement): void {
  let byTab = false;
  addEventListener("keydown", ({ key }) => (byTab = key === "Tab"), { capture: true });
  addEventListener(
    "pointerdown",
    () => {
      byTab = false;
      view.classList.remove("framed");
    },
    { capture: true },
  );
  view.addEventListener("focus", () => view.classList.toggle("framed", byTab));
  view.addEventListener("blur", () => view.classList.remove("framed"));
}
