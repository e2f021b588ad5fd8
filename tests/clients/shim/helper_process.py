"""Starts a helper that sleeps on its own, and programs that move module 1 of an arm, one after the other:
helper_process.py WAITS DEVICE STEPS."""
import subprocess
import sys
import time

waits, device, steps = sys.argv[1:]
HELPER = """
import time
for _ in range(40):
    time.sleep(0.007)
print('helper', time.monotonic())
"""

with subprocess.Popen([sys.executable, "-c", HELPER], stdout=subprocess.PIPE, text=True) as helper:
    for _ in range(3):
        subprocess.run([waits, "usleep", device, steps], check=True)
        time.sleep(0.011)
    print(helper.stdout.read().strip(), time.monotonic())
    sys.exit(helper.wait())
