#!/usr/bin/env python3
"""Writes a picture of the present world: picture.py [--connect HOST:PORT] [--at SECONDS] FILE.svg"""

import argparse
import time

import visum
from visum.picture import draw


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", help="the SVG file to write")
    parser.add_argument("--connect", default="127.0.0.1:1500", metavar="HOST:PORT")
    parser.add_argument("--at", type=float, default=0.0, metavar="SECONDS", help="wait for this simulated time")
    arguments = parser.parse_args()
    with visum.Client(arguments.connect, name="picture", role="observer") as client:
        world = client.world()
        view = client.read_world()
        while view.sample.sim_time_ns < arguments.at * 1e9:
            time.sleep(0.01)
            view = client.read_world()
        with open(arguments.file, "w", encoding="utf-8") as file:
            file.write(draw(world.description, view.sample))


if __name__ == "__main__":
    main()
