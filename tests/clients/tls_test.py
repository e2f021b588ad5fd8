"""TLS with the real programs, and OpenSSL's own client: who gets in, and what the others are told."""
import os
import subprocess
import unittest

from certificates import WithCertificates
from programs import ARM, BIN, Daemon, visum


class Tls(WithCertificates):
    def daemon(self, *options):
        return Daemon("--clock", "lockstep", *self.files("server"), *options)

    def test_visum_and_scripts_get_in_by_options_and_by_the_environment(self):
        with self.daemon() as daemon:
            self.assertIn("arm", daemon.visum("parts", *self.files("boss")).stdout)
            self.assertIn("arm", daemon.visum("parts", env=self.environment("boss")).stdout)
            script = ("import sys, visum\n"
                      "with visum.Client(sys.argv[1]) as client:\n"
                      "    arm = client.part('arm')\n"
                      "    with arm.lease():\n"
                      "        client.join()\n"
                      "        client.advance_ms(10)\n"
                      "        print(client.tick)\n")
            done = subprocess.run(["/usr/bin/python3", "-c", script, daemon.connect], capture_output=True, text=True, timeout=60,
                                  env={**os.environ, **self.environment("boss"), "PYTHONPATH": str(BIN.parent / "python")})
            self.assertEqual((done.stdout, done.stderr), ("10\n", ""))

    def test_names_decide_the_roles(self):
        tokens = self.folder / "tokens"
        tokens.write_text("admin CN=boss\nobserver CN=camera\n")
        tokens.chmod(0o600)
        with self.daemon("--token-file", tokens) as daemon:
            daemon.visum("step", 5, *self.files("boss"))
            refused = daemon.visum("step", 5, *self.files("camera"), expect=1)
            self.assertIn("this needs the role admin, the session has observer", refused.stderr)
            stopped = daemon.visum("param-set", "arm", "Emergency Stop", "true", *self.files("camera"))
            self.assertEqual(stopped.stderr, "", "anybody may stop")
            refused = daemon.visum("param-set", "arm", "Emergency Stop", "false", *self.files("camera"), expect=1)
            self.assertIn("controller", refused.stderr)

    def test_who_is_not_let_in_is_told_why(self):
        with self.daemon() as daemon:
            plain = daemon.visum("parts", expect=1)
            self.assertIn("this server speaks TLS only", plain.stderr)
            half = daemon.visum("parts", "--tls-ca", self.folder / "ca.pem", expect=1)
            self.assertIn("TLS needs three files", half.stderr)
        with Daemon() as daemon:
            secure = daemon.visum("parts", *self.files("boss"), expect=1)
            self.assertIn("the server does not speak TLS", secure.stderr)

    def test_programs_without_openssl_say_so_where_they_need_it(self):
        (self.folder / "libssl.so.3").write_text("no library")
        environment = os.environ | {"LD_LIBRARY_PATH": str(self.folder)}
        with self.daemon() as daemon:
            for words, code in ((["visumd", ARM, "--port", "0", "--http", "off", *self.files("server")], 2),
                                (["visum", "parts", "--connect", daemon.connect, *self.files("boss")], 1)):
                done = subprocess.run([BIN / words[0], *words[1:]], env=environment, capture_output=True, text=True, timeout=60)
                self.assertRegex(done.stderr, r"TLS: OpenSSL cannot be loaded: .*libssl\.so\.3: file too short; install libssl3")
                self.assertEqual(done.returncode, code)

    def test_nothing_older_than_1_3_and_nobody_without_a_certificate(self):
        with self.daemon() as daemon:
            def handshake(*words):
                return subprocess.run(["openssl", "s_client", "-connect", daemon.connect, "-CAfile", self.folder / "ca.pem", *words],
                                      input="", capture_output=True, text=True, timeout=60)
            old = handshake("-tls1_2", "-cert", self.folder / "boss.pem", "-key", self.folder / "boss.key")
            self.assertNotEqual(old.returncode, 0)
            self.assertIn("protocol version", old.stderr)
            self.assertIn("certificate required", handshake("-ign_eof").stderr)
            self.assertIn("arm", daemon.visum("parts", *self.files("boss")).stdout, "it goes on")

    def test_wrong_files_are_named_before_anything_else(self):
        def start(*options):
            return subprocess.run([BIN / "visumd", ARM, "--port", "0", *map(str, options)], capture_output=True,
                                  text=True, timeout=60)
        cert = self.folder / "server.pem"
        half = start("--tls-cert", cert)
        self.assertEqual(half.returncode, 2)
        self.assertIn("--tls-key", half.stderr + half.stdout)
        wrong = start("--tls-cert", cert, "--tls-key", self.folder / "boss.key", "--tls-ca", self.folder / "ca.pem")
        self.assertEqual(wrong.returncode, 2)
        self.assertIn("boss.key: holds no private key of the certificate in", wrong.stderr)

    def test_a_mirror_shows_its_certificate_to_both_arms(self):
        def mirror(*options, **more):
            words = (BIN / "visum-mirror", "--primary", one.connect, "--shadow", other.connect, "--port", 0, "--http", "off", *options)
            return subprocess.run(list(map(str, words)), capture_output=True, text=True, timeout=60, **more)
        with Daemon(*self.files("server")) as one, Daemon(*self.files("server")) as other:
            arm_files = [word.replace("--tls", "--arm-tls") if isinstance(word, str) else word for word in self.files("boss")]
            done = mirror("--iterations", 20, *arm_files)
            self.assertEqual(done.returncode, 0, done.stderr)
            done = mirror("--iterations", 20, env={**os.environ, **self.environment("boss")})
            self.assertEqual(done.returncode, 0, done.stderr)
            refused = mirror()
            self.assertEqual(refused.returncode, 2)
            self.assertIn("this server speaks TLS only", refused.stderr)

    def test_runs_have_a_daemon_of_their_own_whatever_the_environment_says(self):
        scenario = self.folder / "scenario.yaml"
        scenario.write_text(f"visum_scenario: 1\nname: n\nscene: {ARM}\nuntil: {{at_s: 0.05}}\n")
        visum("run", scenario, env=self.environment("boss"))


if __name__ == "__main__":
    unittest.main()
