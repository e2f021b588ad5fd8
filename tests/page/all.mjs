// Runs every test of this folder, one after the other in one browser.
import "./page.test.mjs";
import "./safe.test.mjs";
import "./tool.test.mjs";
import "./world.test.mjs";
import "./modules.test.mjs";
import "./look.test.mjs";
import "./overlays.test.mjs";
import "./sensors.test.mjs";
import "./mirror.test.mjs";
import "./stereo.test.mjs";
import "./recording.test.mjs";
import "./compare.test.mjs";
import "./browse.test.mjs";
import "./https.test.mjs";
