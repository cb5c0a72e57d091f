// @ts-check
// Starts the page, part by part.

import { startBulge } from "./bulge-panel.js";
import { startColumns } from "./columns.js";
import { startConnection } from "./connection.js";
import { startDataPanel } from "./data-panel.js";
import { startDiagnosis } from "./diagnosis-panel.js";
import { startEffects } from "./effects-panel.js";
import { startExclusion } from "./exclusion.js";
import { startExport } from "./export-menu.js";
import { startFooter } from "./footer.js";
import { startHeadline } from "./headline.js";
import { startLadder } from "./ladder.js";
import { startMusclePanel } from "./muscle-panel.js";
import { startNotices } from "./notices.js";
import { startOwnEffect } from "./own-effect.js";
import { startPlan } from "./plan-panel.js";
import { startPlots } from "./plots.js";
import { keepView, load, state } from "./store.js";
import { startTabs } from "./tabs.js";
import { startTheme } from "./theme.js";
import { startTimings } from "./timings.js";

// First what says that something failed, then the rest.
startNotices();
startTimings();
startTheme();
startTabs();
startHeadline();
startDataPanel();
startColumns();
startPlots({
  get rows() { return state.rows; },
  get data() { return JSON.stringify([state.session?.data, state.session?.columns]); },
  get measured() { return JSON.stringify([state.session?.data, state.session?.columns, state.session?.excluded, state.session?.muscle.toml]); },
  get isPath() { return state.comparison?.data.is_path ?? true; },
  get hasEffects() { return state.effects.length > 0; },
  get floor() { return state.comparison?.noise_floor?.sd_n; },
  scrolls: false,
  get view() { return state.session?.view ?? {}; },
  keepView,
});
startExclusion();
startLadder();
startEffects();
startOwnEffect();
startDiagnosis();
startPlan();
startExport();
startFooter();
startBulge();
startConnection();
void startMusclePanel();
void load();
