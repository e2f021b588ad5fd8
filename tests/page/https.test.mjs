// The page of a daemon that speaks TLS. A browser with a certificate may do what the certificate's name
// allows; a browser without one gets nothing. Playwright's own TLS shows the certificates, because Chromium
// picks one only when a person answers its dialogue. The daemon's certificate is taken on trust, as by a
// user who clicks the warning away.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { once } from "node:events";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { body, browser, browserTest, closePages, control, look } from "./harness.mjs";
import { Daemon, openPage, until } from "./programs.mjs";

class Secured extends Daemon {
  static async start() {
    const daemon = new Secured();
    daemon.folder = mkdtempSync(join(tmpdir(), "visum-page-"));
    daemon.makeCertificates("server", "boss", "camera");
    writeFileSync(daemon.file("tokens"), "admin CN=boss\nobserver CN=camera\n", { mode: 0o600 });
    const [certificate, key, authority] = ["server.pem", "server.key", "ca.pem"].map((name) => daemon.file(name));
    await daemon.serve("-v", "1", "--tls-cert", certificate, "--tls-key", key, "--tls-ca", authority, "--token-file", daemon.file("tokens"));
    return daemon;
  }
  file(name) {
    return join(this.folder, name);
  }
  makeCertificates(...names) {
    const openssl = (...words) => execFileSync("openssl", words, { cwd: this.folder, stdio: "pipe" });
    const request = ["req", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes"];
    openssl(...request, "-x509", "-subj", "/CN=authority", "-keyout", "ca.key", "-out", "ca.pem");
    writeFileSync(this.file("names"), "subjectAltName=DNS:localhost,IP:127.0.0.1\n");
    for (const name of names) {
      openssl(...request, "-subj", `/CN=${name}`, "-keyout", `${name}.key`, "-out", `${name}.csr`);
      openssl("x509", "-req", "-in", `${name}.csr`, "-CA", "ca.pem", "-CAkey", "ca.key", "-CAcreateserial", "-extfile", "names", "-out", `${name}.pem`);
    }
  }
  // Options of a browser context that shows the certificate of `name`.
  as(name) {
    const origin = new URL(this.url).origin;
    return { ignoreHTTPSErrors: true, clientCertificates: [{ origin, certPath: this.file(`${name}.pem`), keyPath: this.file(`${name}.key`) }] };
  }
  async stop() {
    await super.stop();
    rmSync(this.folder, { recursive: true });
  }
}

function httpsTest(name, run) {
  browserTest(name, async () => {
    const daemon = await Secured.start();
    try {
      assert.match(daemon.url, /^https:/);
      await run(daemon);
    } finally {
      await closePages();
      await daemon.stop();
    }
  });
}

httpsTest("over https, a user with a certificate moves the arm and sees it move", async (daemon) => {
  const page = await openPage(browser, daemon, daemon.as("boss"));
  assert.equal(await page.evaluate(() => location.protocol), "https:");
  await look(page, "Above");
  const before = await body(page, "arm/link_7");
  await control(page);
  await page.evaluate(() => visum.write("arm", "Desired Angle 1", 0.8));
  await until(page, () => visum.read("arm", "Actual Angle 1") > 0.79);
  await until(page, ({ x, y }) => {
    const now = visum.project("arm/link_7");
    return Math.hypot(now.x - x, now.y - y) > 40;
  }, before);
  assert.deepEqual(page.faults, []);
});

httpsTest("over https, the name in the certificate decides what is allowed", async (daemon) => {
  const page = await openPage(browser, daemon, daemon.as("camera"));
  const refusal = await page.evaluate(() => visum.acquire("arm").then(() => "none", (error) => error.message));
  assert.match(refusal, /observer/);
});

// How a browser words the refusal is its own affair, and changes with its versions.
httpsTest("over https, a browser without a certificate sees nothing", async (daemon) => {
  const context = await browser.newContext({ ignoreHTTPSErrors: true });
  const page = await context.newPage();
  const answers = [];
  page.on("response", (response) => answers.push(response.url()));
  await assert.rejects(page.goto(daemon.url), /net::ERR_/);
  assert.deepEqual(answers, [], "the daemon answered nothing");
  await logged(daemon, /127\.0\.0\.1:\d+ is refused: the client shows no certificate/);
});

// The daemon's log comes through a pipe, and may come after the browser has given up.
async function logged(daemon, wanted) {
  while (!wanted.test(daemon.log)) await once(daemon.process.stderr, "data");
}
