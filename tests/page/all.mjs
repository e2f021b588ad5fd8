// Every test of this folder, one after the other in one browser.
import "./page.test.mjs";
import "./browse.test.mjs";
