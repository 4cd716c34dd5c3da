"""Times an evaluation script of the same job from inside Python: start-up and imports do not count.

    peer.py SCRIPT          SCRIPT is a module with run(folder, jobs=N)

Reads one request a line, `JOBS FOLDER`; answers with the seconds that run() took and the peak memory of the process in MB.
"""
import importlib.util
import resource
import sys
import time

spec = importlib.util.spec_from_file_location("peer", sys.argv[1])
peer = importlib.util.module_from_spec(spec)
sys.modules["peer"] = peer
spec.loader.exec_module(peer)

for line in sys.stdin:
    jobs, folder = line.rstrip("\n").split(" ", 1)
    start = time.perf_counter()
    peer.run(folder, jobs=int(jobs))
    seconds = time.perf_counter() - start
    print(seconds, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024, flush=True)
