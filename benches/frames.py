#!/usr/bin/env python3
"""Measures the cost of frames of sensors, and checks that none is lost. Prints each result with its required value.

    cargo build --release && python3 benches/frames.py [SECONDS] [FILE]

SECONDS is the length of the long run (default 60); FILE is a recording whose replay is measured. One part needs socat.
"""
import fcntl
import os
import pty
import random
import re
import resource
import select
import shutil
import signal
import statistics
import struct
import subprocess
import sys
import tempfile
import termios
import time

TAXEL = os.environ.get("TAXEL", os.path.join(os.path.dirname(os.path.abspath(__file__)), "../target/release/taxel"))
SECONDS = float(sys.argv[1]) if len(sys.argv) > 1 else 60.0
RECORDING = sys.argv[2] if len(sys.argv) > 2 else None
random.seed(1)


def figure(what, found, asked, holds):
    print(f"{'ok ' if holds else 'NOT'} {what}: {found} (asked: {asked})", flush=True)


def line(number, side):
    """Returns a frame in one line: its number, then noise up to 30 with a moving disc of values from 2,000 to 4,000."""
    x, y = side / 2 + 0.2 * side * ((number % 50) / 50 - 0.5), side / 2
    values = [number % 10000]
    for index in range(1, side * side):
        column, row = index % side, index // side
        inside = (column - x) ** 2 + (row - y) ** 2 < (side / 5) ** 2
        values.append(random.randrange(2000, 4000) if inside else random.randrange(30))
    return (" ".join(map(str, values)) + "\n").encode()


def records(path):
    """Returns the number of records in an array that taxel has written, and the number that each record carries."""
    with open(path, "rb") as file:
        head = file.read(256)
        count = int(re.search(rb"'shape': \((\d+),", head).group(1))
        rows, columns = map(int, re.search(rb"'values', '<f8', \((\d+), (\d+)\)", head).groups())
        size = 16 + 8 * rows * columns
        numbers = []
        for index in range(count):
            file.seek(256 + index * size + 8)
            numbers.append(struct.unpack("<Q", file.read(8))[0])
    return count, numbers


class Screen:
    """The program in a pseudo-terminal."""

    def __init__(self, arguments, folder, size=(24, 80)):
        self.pid, self.master = pty.fork()
        if self.pid == 0:
            os.chdir(folder)
            environment = {"TERM": "xterm-256color", "LANG": "C.UTF-8", "HOME": folder, "PATH": os.environ["PATH"]}
            environment["TAXEL_LIBRARY"] = os.path.join(folder, "library")
            os.execve(TAXEL, [TAXEL, *arguments], environment)
        fcntl.ioctl(self.master, termios.TIOCSWINSZ, struct.pack("HHHH", *size, 0, 0))
        self.bytes = b""

    def take(self):
        """Reads the available output."""
        self.bytes += os.read(self.master, 1 << 16)

    def read(self, seconds):
        """Reads for some time. Returns the number of bytes."""
        end, before = time.monotonic() + seconds, len(self.bytes)
        while (left := end - time.monotonic()) > 0:
            if select.select([self.master], [], [], left)[0]:
                try:
                    self.take()
                except OSError:  # the program has ended
                    break
        return len(self.bytes) - before

    def until(self, pattern, seconds=30.0):
        """Reads until new output contains a text. Returns the seconds that this took."""
        start, at = time.monotonic(), len(self.bytes)
        while not re.search(pattern, self.bytes[at:]):
            if time.monotonic() - start > seconds:
                raise SystemExit(f"waited in vain for {pattern}")
            if select.select([self.master], [], [], 0.05)[0]:
                self.take()
        return time.monotonic() - start

    def end(self):
        os.kill(self.pid, signal.SIGTERM)
        self.read(0.3)
        os.waitpid(self.pid, 0)

    def memory(self):
        """Returns the resident memory in MB."""
        with open(f"/proc/{self.pid}/status") as status:
            return int(re.search(r"VmRSS:\s+(\d+)", status.read()).group(1)) / 1024


def thousand_a_second(folder):
    fifo = os.path.join(folder, "long")
    os.mkfifo(fifo)
    file = os.path.join(folder, "long.npy")
    lines = [line(number, 64) for number in range(50)]
    arguments = [TAXEL, "watch", fifo, "--format", "lines", "--rows", "64", "--columns", "64", "--at-least", "1000"]
    child = subprocess.Popen([*arguments, "--write", file], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    count = int(1000 * SECONDS)
    with open(fifo, "wb", buffering=0) as pipe:
        start = time.monotonic()
        for number in range(0, count, 10):
            pipe.write(b"".join(lines[(number + index) % 50] for index in range(10)))
            time.sleep(max(0.0, start + (number + 10) / 1000 - time.monotonic()))
        took = time.monotonic() - start
    _, status, usage = os.wait4(child.pid, 0)
    found, numbers = records(file)
    rate = sum(map(len, lines)) / 50 * count / took / 1e6
    whole = found == count and numbers == list(range(count))
    figure(f"64 x 64 at {count / took:.0f} frames/s, {rate:.1f} MB/s for {took:.0f} s, recorded", f"{found} of {count}", "all", whole)
    share = (usage.ru_utime + usage.ru_stime) / took
    figure("  processor, with every frame described as JSON", f"{100 * share:.1f} % of a core", "15 %", share <= 0.15)
    os.remove(file)


def memory(folder):
    fifo = os.path.join(folder, "memory")
    os.mkfifo(fifo)
    arguments = ["watch", fifo, "--format", "lines", "--rows", "64", "--columns", "64", "--at-least", "1000"]
    screen = Screen(arguments, folder)
    lines = [line(number, 64) for number in range(50)]
    pipe = os.open(fifo, os.O_WRONLY)
    found = []
    for count in (1800, 16200, 90000):
        sent, start = 0, time.monotonic()
        while sent < count:
            os.write(pipe, b"".join(lines))
            sent += 50
            # A hundred times as fast as the sensor, but no faster: input that is waiting to be shown takes memory,
            # too.
            time.sleep(max(0.0, start + sent / 3000 - time.monotonic()))
            screen.read(0.0)
            while select.select([screen.master], [], [], 0)[0]:
                screen.take()
        time.sleep(1.0)
        screen.read(0.2)
        found.append(screen.memory())
    os.close(pipe)
    screen.end()
    more = found[2] - found[0]
    what = "memory of the live page after 1, 10 and 60 minutes of 64 x 64 at 30 frames/s"
    figure(what, ", ".join(f"{own:.1f}" for own in found) + " MB", "± 1 MB", abs(more) <= 1.0)


def stopped_terminal(folder):
    if not shutil.which("socat"):
        print("SKIPPED: no socat")
        return
    ours, theirs = os.path.join(folder, "ours"), os.path.join(folder, "theirs")
    socat = subprocess.Popen(["socat", f"pty,raw,echo=0,link={ours}", f"pty,raw,echo=0,link={theirs}"])
    while not (os.path.exists(ours) and os.path.exists(theirs)):
        time.sleep(0.01)
    file = os.path.join(folder, "serial.npy")
    arguments = ["watch", theirs, "--baud", "2000000", "--format", "lines", "--rows", "16", "--columns", "16"]
    screen = Screen([*arguments, "--at-least", "1000", "--write", file], folder)
    screen.until(b"no frame yet")
    screen.read(0.5)
    frames = [line(number, 16) for number in range(5000)]
    size = sum(map(len, frames)) / len(frames)
    rate = 200_000 / size
    line_in = os.open(ours, os.O_WRONLY)
    # The first line may be torn.
    os.write(line_in, b"1 2 3\n")
    start, sent = time.monotonic(), 0
    while time.monotonic() - start < 12.0:
        os.write(line_in, frames[sent])
        sent += 1
        if sent % 20 == 0:
            time.sleep(max(0.0, start + sent / rate - time.monotonic()))
        if time.monotonic() - start < 1.0:
            screen.read(0.0)
            while select.select([screen.master], [], [], 0)[0]:
                screen.take()
    # For more than ten seconds the terminal is not read. Meanwhile everything is recorded.
    time.sleep(1.0)
    # The backlog comes first, then the newest picture, then nothing more.
    start = last = time.monotonic()
    while time.monotonic() - last < 0.5:
        if select.select([screen.master], [], [], 0.1)[0]:
            screen.take()
            last = time.monotonic()
    took = last - start
    os.close(line_in)
    screen.read(0.5)
    screen.end()
    socat.terminate()
    socat.wait()
    count, numbers = records(file)
    figure(f"{sent * size / 12.0 / 1000:.0f} kB/s by socat, terminal not read for 11 s, recorded", f"{count} of {sent}", "all", count == sent)
    figure("  newest picture after the terminal is read again", f"{1000 * took:.0f} ms", "100 ms", took <= 0.1)


def latency(folder):
    fifo = os.path.join(folder, "latency")
    os.mkfifo(fifo)
    screen = Screen(["watch", fifo, "--format", "lines", "--rows", "16", "--columns", "16", "--at-least", "1000"], folder)
    pipe = os.open(fifo, os.O_WRONLY)
    os.write(pipe, line(0, 16))
    screen.until(b"frame 0")
    took = []
    for number in range(1, 101):
        screen.read(0.05 + 0.01 * random.random())
        frame = line(number, 16)
        start = time.monotonic()
        at = len(screen.bytes)
        os.write(pipe, frame)
        while len(screen.bytes) == at:
            if select.select([screen.master], [], [], 1.0)[0]:
                screen.take()
        took.append(time.monotonic() - start)
    figure("frame to screen, median of 100", f"{1000 * statistics.median(took):.1f} ms", "50 ms", statistics.median(took) <= 0.05)
    # After two seconds without a frame, the screen says so.
    screen.read(3.0)
    quiet = screen.read(3.0)
    figure("bytes in 3 s without a change", quiet, "0", quiet == 0)
    os.close(pipe)
    screen.end()


def draws(folder):
    fifo = os.path.join(folder, "draws")
    os.mkfifo(fifo)
    screen = Screen(["watch", fifo, "--format", "lines", "--rows", "16", "--columns", "16", "--at-least", "1000"], folder)
    pipe = os.open(fifo, os.O_WRONLY)
    os.write(pipe, line(0, 16))
    screen.until(b"frame 0")
    at, start = len(screen.bytes), time.monotonic()
    for number in range(1, 1001):
        os.write(pipe, line(number, 16))
        screen.read(0.002)
    took = time.monotonic() - start
    count = screen.bytes[at:].count(b"\x1b[?2026h")
    figure(f"pictures a second at {1000 / took:.0f} frames/s", f"{count / took:.1f}", "30", count / took <= 30.5)
    os.close(pipe)
    screen.end()


def replay(folder):
    if not RECORDING:
        print("SKIPPED: no recording to replay is named")
        return
    screen = Screen(["watch", os.path.abspath(RECORDING), "--at-least", "10"], folder)
    screen.until(b"frame 0")
    start = time.monotonic()
    count = screen.read(20.0)
    took = time.monotonic() - start
    figure("bytes a second of a replay in 256 colours, 80 x 24", f"{count / took / 1000:.2f} kB/s", "5 kB/s", count / took <= 5000)
    screen.end()


with tempfile.TemporaryDirectory() as folder:
    print(subprocess.run([TAXEL, "--version"], capture_output=True, text=True).stdout.strip(), "on", os.cpu_count(), "cores")
    for part in (latency, draws, stopped_terminal, replay, memory, thousand_a_second):
        part(folder)
