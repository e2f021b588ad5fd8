"""An authority, and certificates that it signed, made anew by OpenSSL for the length of a suite."""
import pathlib
import subprocess
import tempfile
import unittest


class WithCertificates(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.kept = tempfile.TemporaryDirectory(prefix="visum_certificates_")
        cls.folder = pathlib.Path(cls.kept.name)
        cls.sign_itself("authority", "ca")
        for name in ("server", "boss", "camera"):
            cls.sign(name)

    @classmethod
    def tearDownClass(cls):
        cls.kept.cleanup()

    @classmethod
    def openssl(cls, *words, **more):
        done = subprocess.run(["openssl", *map(str, words)], cwd=cls.folder, capture_output=True, text=True, timeout=60, **more)
        if done.returncode != 0:
            raise AssertionError(f"openssl {words}: {done.stderr}")
        return done

    @classmethod
    def sign_itself(cls, name, file):
        cls.openssl("req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days", 2,
                    "-subj", f"/CN={name}", "-keyout", f"{file}.key", "-out", f"{file}.pem")

    @classmethod
    def sign(cls, name, days=2, subject=None):
        """A certificate of the authority; one of a negative number of days has expired. `name` is that of its files, too."""
        cls.openssl("req", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-utf8",
                    "-subj", subject or f"/CN={name}", "-keyout", f"{name}.key", "-out", f"{name}.csr")
        (cls.folder / "names").write_text("subjectAltName=DNS:localhost,IP:127.0.0.1\n")
        cls.openssl("x509", "-req", "-in", f"{name}.csr", "-CA", "ca.pem", "-CAkey", "ca.key", "-CAcreateserial", "-days", days,
                    "-extfile", "names", "-out", f"{name}.pem")

    def files(self, name):
        return ("--tls-ca", self.folder / "ca.pem", "--tls-cert", self.folder / f"{name}.pem", "--tls-key",
                self.folder / f"{name}.key")

    def environment(self, name):
        return {f"VISUM_TLS_{what}": str(file) for what, file in zip(("CA", "CERT", "KEY"), self.files(name)[1::2])}
