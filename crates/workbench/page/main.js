// @ts-check
// Starts the page, part by part.

import { startBulge } from "./bulge-panel.js";
import { startColumns } from "./columns.js";
import { startConnection } from "./connection.js";
import { startDataPanel } from "./data-panel.js";
import { startDiagnosis } from "./diagnosis-panel.js";
import { startEffects } from "./effects-panel.js";
import { startExport } from "./export-menu.js";
import { startFooter } from "./footer.js";
import { startHeadline } from "./headline.js";
import { startLadder } from "./ladder.js";
import { startMusclePanel } from "./muscle-panel.js";
import { startNotices } from "./notices.js";
import { startOwnEffect } from "./own-effect.js";
import { startPlan } from "./plan-panel.js";
import { startPlots } from "./plots.js";
import { startSelection } from "./selection.js";
import { load } from "./store.js";
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
startPlots();
startSelection();
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
