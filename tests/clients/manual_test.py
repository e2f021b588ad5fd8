"""The manual pages: each installed program and each verb has one, with every option of its --help."""
import os
import re
import shutil
import subprocess
import unittest

from programs import BIN, DEADLINE_S, visum

PAGES = BIN.parent / "man1"
PROGRAMS = [name for name in os.environ.get("VISUM_PROGRAMS", "visum,visumd").split(",") if name]


def verbs():
    return re.findall(r"^  ([a-z-]+)  +\w", visum("--help").stdout.split("Subcommands:")[1], re.M)


def commands():
    """(name of the page, the command that it is about)"""
    return [(program, [BIN / program]) for program in PROGRAMS] + [(f"visum-{verb}", [BIN / "visum", verb]) for verb in verbs()]


def help_of(command):
    return subprocess.run([*command, "--help"], capture_output=True, text=True, timeout=DEADLINE_S, check=True).stdout


def plain(page):
    """The text of a page without roff's marks."""
    return re.sub(r"\\f[BIR]", "", (PAGES / f"{page}.1").read_text()).replace("\\-", "-").replace("\\&", "").replace("\\e", "\\")


class Manual(unittest.TestCase):
    def test_every_program_and_every_verb_has_a_page_with_all_options_of_its_help(self):
        self.assertGreater(len(commands()), 30)
        for page, command in commands():
            text = plain(page)
            options = set(re.findall(r"^ {2,}(?:-\w,)?(--[a-z][a-z-]*)", help_of(command), re.M))
            self.assertEqual([option for option in options if not re.search(rf"{option}(?![a-z-])", text)], [], page)
            self.assertTrue(options or page == "visum-serial-arm", page)

    def test_every_page_names_itself_and_its_purpose(self):
        for page, _ in commands():
            self.assertRegex(plain(page), rf"\.SH NAME\n{page} - \w.*\n", page)

    def test_examples_and_exit_codes_have_sections_of_their_own(self):
        for page in ("visum-run", "visum-check", "visumd", "visum-hwpart"):
            self.assertIn("\n.SH EXIT STATUS\n0 ", plain(page))
            self.assertRegex(plain(page), r"\n\.SH EXAMPLES\n\.nf\n(visum|visumd|visum-hwpart) ")

    @unittest.skipUnless(shutil.which("groff"), "needs groff")
    def test_groff_renders_every_page_without_a_warning(self):
        for page, _ in commands():
            done = subprocess.run(["groff", "-ww", "-z", "-Tutf8", "-Kutf8", "-man", PAGES / f"{page}.1"], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""), page)


class Help(unittest.TestCase):
    def test_a_verb_that_another_program_does_shows_the_command_that_was_typed(self):
        for verb in ("check", "convert", "drives", "record", "replay", "rewind", "export", "mirror"):
            text = visum(verb, "--help").stdout
            self.assertIn(f"Usage: visum {verb} ", text)
            self.assertNotIn("visumd " + verb, text)
        for verb in ("check", "convert", "drives", "export"):
            self.assertIn(f"Usage: visumd {verb} ", help_of([BIN / "visumd", verb]))

    def test_it_fits_80_columns(self):
        for page, command in commands():
            if page == "visum-pick-and-place":
                continue  # an example outside of ours: CLI11's own help
            long = [line for line in help_of(command).splitlines() if len(line) > 80 and not line.startswith("  ")]
            self.assertEqual(long, [], page)


class Suggestions(unittest.TestCase):
    def refusal(self, program, *words):
        done = subprocess.run([BIN / program, *words], capture_output=True, text=True, timeout=DEADLINE_S)
        self.assertEqual((done.returncode, done.stdout), (2, ""), words)
        return done.stderr.splitlines()[0]

    def test_of_a_verb(self):
        self.assertEqual(self.refusal("visum", "prats"), "visum: there is no verb 'prats'; did you mean 'parts'?")
        self.assertEqual(self.refusal("visumd", "chekc", "x"), "visumd: there is no verb 'chekc'; did you mean 'check'?")
        self.assertEqual(self.refusal("visum"), "visum: a verb is missing")

    def test_of_an_option(self):
        self.assertEqual(self.refusal("visum", "--versoin"), "visum: there is no option '--versoin'; did you mean '--version'?")
        self.assertEqual(self.refusal("visum", "--bogus"), "visum: there is no option '--bogus'; there are: --help, --version")
        for program, name in (("visumd", "visumd"), ("visum-hwpart", "visum-hwpart"), ("visum-mirror", "visum-mirror")):
            self.assertEqual(self.refusal(program, "--prot", "0"), f"{name}: there is no option '--prot'; did you mean '--port'?")
        self.assertEqual(self.refusal("visum-agent", "--tmie=1"), "visum-agent: there is no option '--tmie'; did you mean '--time'?")
        self.assertEqual(self.refusal("visum", "run", "x", "--jbos", "2"), "visum run: there is no option '--jbos'; did you mean '--jobs'?")
        self.assertEqual(self.refusal("visum", "check", "--plugin", "."), "visum check: there is no option '--plugin'; did you mean '--plugins'?")
        self.assertEqual(self.refusal("visum", "replay", "x", "--prot", "0"), "visum replay: there is no option '--prot'; did you mean '--port'?")

    def test_of_a_choice(self):
        for program, words in (("visumd", ()), ("visum", ("run",))):
            self.assertEqual(self.refusal(program, *words, "x", "--clock", "realtme"),
                             f"{' '.join((program, *words))}: --clock: must be one of realtime, lockstep, free, is 'realtme'; "
                             "did you mean 'realtime'?")


if __name__ == "__main__":
    unittest.main()
