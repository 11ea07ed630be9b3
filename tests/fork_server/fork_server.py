"""Starts runs of slipstick through the program fork_server. Standard library only."""

import json
import os
import pathlib
import signal
import subprocess
import tempfile
import threading


class ForkServer:
    """One server: one run at a time. Threads that run side by side have a server each."""

    def __init__(self, program, environment):
        self.process = subprocess.Popen([str(program)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment)
        self.place = tempfile.TemporaryDirectory(prefix='slipstick-fork-')
        self.lock = threading.Lock()

    def close(self):
        self.process.stdin.close()
        self.process.wait()
        self.process.stdout.close()
        self.place.cleanup()

    def number(self):
        line = self.process.stdout.readline()
        if not line:
            raise RuntimeError('the fork server has ended with status {}'.format(self.process.wait()))
        return int(line)

    def run(self, arguments, directory, time_limit, memory=0):
        """Returns the exit status (minus the signal that ended it), what was printed as bytes (stdout, stderr), and whether the
        time limit was hit; such a run gets SIGTERM, and SIGKILL 10 s later."""
        with self.lock:
            files = [pathlib.Path(self.place.name) / name for name in ('stdout', 'stderr')]
            for file in files:
                file.write_bytes(b'')  # of a child that dies before it opens them
            request = {'arguments': [os.fsdecode(argument) for argument in arguments], 'directory': str(directory),
                       'stdout': str(files[0]), 'stderr': str(files[1]), 'memory': memory}
            self.process.stdin.write(json.dumps(request) + '\n')
            self.process.stdin.flush()
            group = self.number()
            timers = [threading.Timer(time_limit, os.killpg, (group, signal.SIGTERM)),
                      threading.Timer(time_limit + 10, os.killpg, (group, signal.SIGKILL))]
            for timer in timers:
                timer.start()
            status = self.number()
            late = not timers[0].is_alive()
            for timer in timers:
                timer.cancel()
            return status, files[0].read_bytes(), files[1].read_bytes(), late
