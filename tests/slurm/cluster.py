"""A Slurm of one node on loopback, with folders, ports, key and daemons of its own; ended by process ids."""

import ctypes
import os
import pwd
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

PR_SET_PDEATHSIG = 1
PR_SET_CHILD_SUBREAPER = 36
libc = ctypes.CDLL(None, use_errno=True)

CONFIGURATION = """
ClusterName=loopback
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller_port}
SlurmdPort={node_port}
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket,cred_expire=20
CredType=cred/munge
SlurmUser=root
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/builtin
SchedulerParameters=sched_min_interval=100000,sched_interval=1,batch_sched_delay=0
PriorityType=priority/basic
PreemptType=preempt/partition_prio
PreemptMode=REQUEUE
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/filetxt
JobCompLoc={folder}/completed
SlurmdParameters=config_overrides
MpiDefault=none
SwitchType=switch/none
ReturnToService=2
SlurmctldTimeout=60
SlurmdTimeout=10
KillWait=5
MinJobAge=3600
MailProg=/bin/true
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
NodeName={host} NodeAddr=127.0.0.1 CPUs=2 RealMemory=4096 State=UNKNOWN
PartitionName=low Nodes={host} Default=YES MaxTime=60 DefaultTime=30 PriorityTier=1 PreemptMode=REQUEUE GraceTime=3
PartitionName=high Nodes={host} MaxTime=60 DefaultTime=30 PriorityTier=10 PreemptMode=OFF
"""


def missing():
    """What keeps a Slurm from being started here; empty where nothing does."""
    if os.geteuid() != 0:
        return "needs root: munged and slurmd run as other users"
    for program in ("munged", "slurmctld", "slurmd", "sbatch", "scontrol"):
        if not find(program):
            return f"no {program} here: packages munge and slurm-wlm"
    return ""


def find(program):
    return shutil.which(program, path=os.environ.get("PATH", "") + ":/usr/sbin:/sbin")


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


def children(pid):
    """All descendants of a process, from /proc."""
    parents = {}
    for name in os.listdir("/proc"):
        if name.isdigit():
            try:
                with open(f"/proc/{name}/stat") as stat:
                    parents.setdefault(int(stat.read().rsplit(")", 1)[1].split()[1]), []).append(int(name))
            except OSError:
                pass
    found, open_ids = [], [pid]
    while open_ids:
        for child in parents.get(open_ids.pop(), []):
            found.append(child)
            open_ids.append(child)
    return found


def command_line(pid):
    try:
        with open(f"/proc/{pid}/cmdline", "rb") as line:
            return line.read().replace(b"\0", b" ").decode(errors="replace").strip()
    except OSError:
        return ""


def text_of(path):
    """A file's text; empty where there is none."""
    try:
        with open(path, errors="replace") as file:
            return file.read()
    except OSError:
        return ""


def kill(pid, number=signal.SIGKILL):
    try:
        os.kill(pid, number)
    except ProcessLookupError:
        pass


def wait_until(what, condition, seconds=600):
    """Polls; a limit so that a test which hangs says where. Orphans that were handed to this process are buried meanwhile:
    Slurm takes a task for running while one of its processes is still in the table."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        reap()
        result = condition()
        if result:
            return result
        time.sleep(0.1)
    raise TimeoutError(f"waited {seconds} s for: {what}")


def in_guarded_folder(work):
    """Runs work(folder) in a child process and answers its exit status. Whatever becomes of that process or of this one,
    every process they started is ended and the folder removed: daemons and job steps that part from their parents
    are handed to this process, which ends what is left of its descendants."""
    libc.prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    folder = tempfile.mkdtemp(prefix="toile_slurm_")
    os.chmod(folder, 0o755)  # the munge user passes through
    guard = os.getpid()
    worker = os.fork()
    if worker == 0:
        libc.prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
        die_with_parent(signal.SIGTERM)
        if os.getppid() != guard:
            os._exit(1)
        signal.signal(signal.SIGTERM, interrupt)
        status = 1
        try:
            status = work(folder)
        finally:
            end_descendants(os.getpid())
            if os.getppid() != guard:  # nobody else is left to do it
                shutil.rmtree(folder, ignore_errors=True)
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(status)
    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
        signal.signal(number, lambda *_: kill(worker, signal.SIGTERM))
    status = 1
    try:
        status = os.waitstatus_to_exitcode(os.waitpid(worker, 0)[1])
    finally:
        end_descendants(guard)
        shutil.rmtree(folder, ignore_errors=True)
    return status


def interrupt(*_):
    signal.signal(signal.SIGTERM, signal.SIG_IGN)  # once is enough: what follows is tidying up
    raise KeyboardInterrupt


def die_with_parent(number=signal.SIGKILL):
    libc.prctl(PR_SET_PDEATHSIG, number, 0, 0, 0)


def end_descendants(pid):
    while True:
        left = children(pid)
        for one in left:
            kill(one)
        reap()
        if not left:
            return
        time.sleep(0.02)


def reap():
    try:
        while os.waitpid(-1, os.WNOHANG)[0]:
            pass
    except ChildProcessError:
        pass


class Cluster:
    """Starts munged, slurmctld and slurmd in the folder; commands run with its configuration."""

    def __init__(self, folder):
        self.folder = folder
        self.host = socket.gethostname().split(".")[0]
        self.environment = dict(os.environ, SLURM_CONF=f"{folder}/slurm.conf",
                                PATH=os.environ.get("PATH", "") + ":/usr/sbin:/sbin")
        for name in ("state", "spool", "munge"):
            os.mkdir(f"{folder}/{name}", 0o755)
        controller_port, node_port = free_ports(2)
        with open(f"{folder}/slurm.conf", "w") as conf:
            conf.write(CONFIGURATION.format(host=self.host, folder=folder, controller_port=controller_port,
                                            node_port=node_port))
        self.start_munge()
        self.controller = self.daemon("slurmctld", "-D", "-f", f"{folder}/slurm.conf")
        self.node = None
        self.start_node()
        self.wait_for_node("idle")

    def daemon(self, program, *arguments, user=None):
        with open(f"{self.folder}/{program}.out", "ab") as log:
            return subprocess.Popen([find(program), *arguments], env=self.environment, stdin=subprocess.DEVNULL,
                                    stdout=log, stderr=log, cwd=self.folder, start_new_session=True, user=user,
                                    group=user, preexec_fn=die_with_parent)

    def start_munge(self):
        user = "munge" if any(entry.pw_name == "munge" for entry in pwd.getpwall()) else None
        munge = f"{self.folder}/munge"
        with open(f"{munge}/key", "wb") as key:
            key.write(os.urandom(128))
        os.chmod(f"{munge}/key", 0o400)
        if user:
            shutil.chown(munge, user, user)
            shutil.chown(f"{munge}/key", user, user)
        self.munge = self.daemon("munged", "--foreground", f"--key-file={munge}/key", f"--socket={munge}/socket",
                                 f"--pid-file={munge}/pid", f"--log-file={munge}/log", f"--seed-file={munge}/seed",
                                 user=user)
        wait_until("munged's socket", lambda: os.path.exists(f"{munge}/socket"), 30)

    def start_node(self):
        self.node = self.daemon("slurmd", "-D", "-f", f"{self.folder}/slurm.conf", "-N", self.host)

    def kill_node_daemon(self):
        """slurmd alone: what runs on the node goes on."""
        self.node.kill()
        self.node.wait()

    def kill_node(self):
        """slurmd and all that runs on the node, at once: a power cut."""
        steps = [one for one in children(os.getpid()) if "slurmstepd" in command_line(one)]
        steps += [child for step in steps for child in children(step)]
        self.kill_node_daemon()
        for one in steps:
            kill(one)
        reap()

    def wait_for_node(self, state, seconds=90):
        wait_until(f"node {state}", lambda: state in self.run("sinfo", "--noheader", "--format=%T").lower(), seconds)

    def run(self, *command, expected=0):
        done = subprocess.run(command, env=self.environment, capture_output=True, text=True, cwd=self.folder)
        if expected is not None and done.returncode != expected:
            raise AssertionError(f"{' '.join(command)}: exit status {done.returncode}\n{done.stdout}{done.stderr}")
        return done.stdout.strip()

    def job(self, job):
        """Slurm's fields of one job or array task, such as JobState; empty where there is none."""
        text = self.run("scontrol", "--oneliner", "show", "job", str(job), expected=None)
        fields = dict(re.findall(r"(\w+)=(\S*)", text.splitlines()[0])) if text else {}
        return fields

    def state(self, job):
        return self.job(job).get("JobState", "")

    def wait_for_state(self, job, *states, seconds=600):
        wait_until(f"job {job} {' or '.join(states)}, it is {self.state(job)}",
                   lambda: self.state(job) in states, seconds)

    def processes(self, *words):
        """Processes of ours whose command line holds all the words."""
        return [one for one in children(os.getpid()) if all(word in command_line(one) for word in words)]

    def release_requeued_until_end(self, jobs, seconds=600):
        """Waits until all have ended; a requeued task would wait until its old credential expires, and is let go at once."""

        def ended():
            for job in jobs:
                fields = self.job(job)
                if fields.get("JobState") == "PENDING" and fields.get("Reason") == "BeginTime":
                    self.run("scontrol", "update", f"JobId={job}", "StartTime=now", expected=None)
            return all(self.state(job) not in ("PENDING", "RUNNING", "COMPLETING", "CONFIGURING") for job in jobs)

        wait_until(f"end of {jobs}", ended, seconds)
