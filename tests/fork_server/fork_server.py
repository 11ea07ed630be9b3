"""Starts the program fork_server. Standard library only."""

import pathlib
import subprocess
import tempfile


class ForkServer:
    """`client` stands for slipstick, alone or below mpirun, in the environment `variables`; any number of runs at a time."""

    def __init__(self, program, environment):
        self.place = tempfile.TemporaryDirectory(prefix='slipstick-fork-')
        socket = str(pathlib.Path(self.place.name) / 'socket')
        self.process = subprocess.Popen([str(program), socket], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
                                        env=environment)
        if self.process.stdout.readline() != 'ready\n':
            raise RuntimeError('the fork server has ended with status {}'.format(self.process.wait()))
        self.client = str(pathlib.Path(program).parent / 'fork_client')
        self.variables = {'SLIPSTICK_FORK_SOCKET': socket}

    def close(self):
        self.process.stdin.close()
        self.process.wait()
        self.process.stdout.close()
        self.place.cleanup()
