"""The programs of one run meet on a Unix socket."""
import sys
import unittest

from programs import BIN
from run_test import Scenario


class Socket(Scenario):
    def test_all_programs_of_a_run_meet_on_a_unix_socket(self):
        program = self.folder / "count.py"
        # A server's end of a connection has the name of the socket where it came in, and the state 3
        program.write_text("import sys, visum\nwith visum.Client(sys.argv[1], name='c') as client:\n    client.join()\n"
                           "    client.advance_ms(5)\n    with open('/proc/net/unix') as sockets:\n"
                           "        print(sum(f'-{sys.argv[2]}\\n' in line and line.split()[5] == '03' for line in sockets))\n")
        _, done = self.run_it(f"controllers: [{{name: c, exchanges: false, command: [env, PYTHONPATH={BIN.parent / 'python'}, "
                              f"{sys.executable}, {program}, '{{connect}}', '{{port}}']}}]\n")
        self.assertIn("c | 3\n", done.stderr, "the controller, and visum run twice")


if __name__ == "__main__":
    unittest.main()
