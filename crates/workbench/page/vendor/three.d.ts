// What the bundle exports, for the check of types.
export * from "three";
export { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
