// What the bundle exports, for the check of types.
export { init, use } from "echarts/core";
