// All of the scene's text, loaded as one: what it shares with the page then comes in one piece, too.
export { TextDrawer } from "./drawer";
export { takeScene } from "./drop";
export { loadKept, offer } from "./offer";
