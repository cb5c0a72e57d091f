"""Sweeps and diagnoses on Dask: the same bytes as on one machine, whatever the workers do."""

import hashlib
import json
import os
import signal
import sys
import threading
import time

import pytest

distributed = pytest.importorskip("distributed")

import bulge  # noqa: E402
import bulge.distributed  # noqa: E402

SWEEP = """
name = "pleated family"
muscle = "{muscle}"
pressure = "1 bar"
outputs = ["force_f", "volume_v"]
design = "grid"
chunk = {chunk}

[axes.contraction]
range = "0.5 %..45 %"
points = 101

[axes.slenderness]
range = "2..100"
points = 40
spacing = "log"
"""

PROTOCOL = """
[[block]]
pressures = ["2 bar", "3 bar", "4 bar"]
contraction = "2 %..16 %"
shape = "loops"
period = "40 s"
rows = 40
[noise]
force = "2 N"
"""


@pytest.fixture(scope="module")
def client():
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, distributed.Client(cluster) as client:
        yield client


def _plan(muscle="ppam-2-r16", chunk=101):
    return bulge.Sweep(SWEEP.format(muscle=muscle, chunk=chunk))


def _hashes(folder):
    files = (path for path in sorted(folder.rglob("*")) if path.is_file() and path.name != ".lock")
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """What one machine writes."""
    folder = tmp_path_factory.mktemp("alone")
    _plan().run(folder / "sweep")
    return _hashes(folder / "sweep")


@pytest.mark.parametrize("chunks_per_task", [None, 1, 7])
def test_a_cluster_writes_the_same_bytes(client, alone, tmp_path, chunks_per_task):
    told = []
    found = bulge.distributed.sweep(
        _plan(), tmp_path / "sweep", client, chunks_per_task=chunks_per_task, progress=lambda share, what: told.append(share)
    )
    assert _hashes(tmp_path / "sweep") == alone
    assert (found.points, found.chunks, found.computed, found.is_complete) == (4040, 40, 40, True)
    assert told[-1] == 1.0 and told == sorted(told)
    assert found.infeasible == json.loads((tmp_path / "sweep" / "manifest.json").read_text())["infeasible"] > 0


@pytest.mark.parametrize("chunks", [None, 5])
@pytest.mark.parametrize("n_chunks, threads", [(1, 1), (7, 3), (1000, 4), (1000, 5000)])
def test_tasks_are_of_the_time_asked_for_and_short_at_the_end(n_chunks, threads, chunks):
    pace = bulge.distributed._Pace(n_chunks, lambda: threads, chunks)
    ranges = []
    for a, b in pace.ranges():
        ranges.append((a, b))
        pace.hear(b - a, {"computed": b - a, "seconds": 0.05 * (b - a)})
    starts, ends = zip(*ranges)
    assert starts == (0, *ends[:-1]) and ends[-1] == n_chunks
    lengths = [b - a for a, b in ranges]
    assert pace.longest == max(lengths)
    if chunks:
        assert set(lengths[:-1]) <= {chunks}
        return
    most = round(bulge.distributed.TASK_SECONDS / 0.05)
    assert max(lengths) <= most and lengths[0] == lengths[-1] == 1
    # Nobody gets more than half of its share of what is left.
    assert all(2 * threads * (length - 1) < n_chunks - start for start, length in zip(starts, lengths))
    assert n_chunks < 10 * most * threads or max(lengths) == most


def test_a_store_gets_the_same_bytes(client, alone, tmp_path):
    url = f"file://{tmp_path}/store"
    found = bulge.distributed.sweep(_plan(), url, client)
    assert _hashes(tmp_path / "store") == alone
    assert found.is_complete and found.computed == 40
    # A damaged chunk is made again, and nothing else.
    (tmp_path / "store" / "points" / "000005.parquet").write_bytes(b"")
    (tmp_path / "store" / "chunks" / "000007.json").write_text("{}")
    again = bulge.distributed.sweep(_plan(), url, client, resume=True)
    assert _hashes(tmp_path / "store") == alone and again.computed == 2


def test_an_object_store_gets_the_same_bytes(client, alone):
    """S3 as moto plays it."""
    server_of = pytest.importorskip("moto.server")
    s3fs = pytest.importorskip("s3fs")
    server = server_of.ThreadedMotoServer(ip_address="127.0.0.1", port=0)
    server.start()
    try:
        host, port = server.get_host_and_port()
        options = {"endpoint_url": f"http://{host}:{port}", "key": "test", "secret": "test"}
        system = s3fs.S3FileSystem(**options)
        system.mkdir("bucket")
        bulge.distributed.sweep(_plan(), "s3://bucket/run", client, storage_options=options)
        with pytest.raises(bulge.InputError, match="resume=True"):
            bulge.distributed.sweep(_plan(), "s3://bucket/run", client, storage_options=options)
        system.pipe("bucket/run/points/000003.parquet", b"damaged")
        system.rm("bucket/run/chunks/000005.json")
        again = bulge.distributed.sweep(_plan(), "s3://bucket/run", client, storage_options=options, resume=True)
        assert again.computed == 2
        there = {path.removeprefix("bucket/run/"): hashlib.sha256(system.cat(path)).hexdigest() for path in system.find("bucket/run")}
        assert there == alone
    finally:
        server.stop()


def test_workers_that_come_later_get_work(alone, tmp_path, monkeypatch):
    monkeypatch.setattr(bulge.distributed, "COUNT_SECONDS", 0.0)
    with (
        distributed.LocalCluster(n_workers=0, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        flying = []
        submit = client.submit

        def counted(*arguments, **options):
            flying.append(len(client.futures))
            return submit(*arguments, **options)

        monkeypatch.setattr(client, "submit", counted)
        cluster.scale(2)
        bulge.distributed.sweep(_plan(), tmp_path / "sweep", client, chunks_per_task=1)
    assert _hashes(tmp_path / "sweep") == alone
    # Four for the one thread that was counted at first, more for two.
    assert max(flying) > bulge.distributed.IN_FLIGHT


@pytest.mark.skipif(sys.platform != "linux", reason="setsid and the name of the loopback are Linux's")
def test_jobs_of_slurm_write_the_same_bytes(alone, tmp_path, monkeypatch):
    """dask-jobqueue as on Slurm; what stands in for `sbatch` runs the script that it is given."""
    before = signal.getsignal(signal.SIGINT)
    jobqueue = pytest.importorskip("dask_jobqueue")
    # It takes Ctrl-C for itself when it is imported.
    signal.signal(signal.SIGINT, before)
    submit, cancel = tmp_path / "bin" / "sbatch", tmp_path / "bin" / "scancel"
    submit.parent.mkdir()
    # Slurm keeps a copy of the script: the file is deleted at once.
    job = f"{tmp_path}/job-$$"
    submit.write_text(f'#!/bin/sh\ncp "$1" "{job}.sh"\nsetsid sh "{job}.sh" > "{job}.log" 2>&1 &\necho "Submitted batch job $!"\n')
    cancel.write_text("#!/bin/sh\nkill -- -$1\n")
    for script in [submit, cancel]:
        script.chmod(0o755)
    monkeypatch.setenv("PATH", str(submit.parent), prepend=os.pathsep)
    with (
        jobqueue.SLURMCluster(
            cores=1, memory="1GB", interface="lo", log_directory=str(tmp_path), scheduler_options={"dashboard_address": None}
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        cluster.scale(jobs=2)
        client.wait_for_workers(2, timeout=60)
        bulge.distributed.sweep(_plan(), tmp_path / "sweep", client)
    assert _hashes(tmp_path / "sweep") == alone


def test_what_is_there_is_not_made_again_and_another_sweep_is_refused(client, alone, tmp_path):
    for folder in (str(tmp_path / "sweep"), f"file://{tmp_path}/store"):
        bulge.distributed.sweep(_plan(), folder, client)
        with pytest.raises(bulge.InputError, match="holds this sweep already"):
            bulge.distributed.sweep(_plan(), folder, client)
        with pytest.raises(bulge.InputError, match="holds another sweep"):
            bulge.distributed.sweep(_plan(chunk=202), folder, client, resume=True)
        assert bulge.distributed.sweep(_plan(), folder, client, resume=True).computed == 0
    assert _hashes(tmp_path / "sweep") == _hashes(tmp_path / "store") == alone


def test_workers_may_be_killed(client, tmp_path):
    # Shooting, so that there is time to die.
    text = SWEEP.format(muscle="dmsp-20-250", chunk=25).replace('45 %"', 'limit"').replace("[axes.slenderness]", "[axes.braid_angle]")
    text = text.replace('"2..100"', '"20 deg..30 deg"').replace('spacing = "log"', "").replace("points = 40", "points = 30")
    plan = bulge.Sweep(text)
    plan.run(tmp_path / "alone")
    killed = []

    def kill():
        for _ in range(2):
            time.sleep(0.3)
            pids = list(client.run(os.getpid).values())
            if pids:
                os.kill(pids[0], signal.SIGKILL)
                killed.append(pids[0])

    killer = threading.Thread(target=kill)
    killer.start()
    found = bulge.distributed.sweep(plan, tmp_path / "sweep", client, chunks_per_task=2)
    killer.join()
    assert len(killed) == 2 and found.is_complete
    assert _hashes(tmp_path / "sweep") == _hashes(tmp_path / "alone")


def test_the_muscle_file_travels_with_the_sweep(client, tmp_path):
    """Workers see only the folder of the result."""
    home = tmp_path / "home"
    home.mkdir()
    bulge.Muscle.preset("ppam-2-r16").replace(radius="17 mm").to_toml(home / "own.toml")
    (home / "sweep.toml").write_text(SWEEP.format(muscle="own.toml", chunk=1000))
    plan = bulge.Sweep.read(home / "sweep.toml")
    plan.run(tmp_path / "alone")
    (home / "own.toml").unlink()
    bulge.distributed.sweep(plan, tmp_path / "sweep", client)
    assert _hashes(tmp_path / "sweep") == _hashes(tmp_path / "alone")


def test_a_suite_is_diagnosed_as_one_by_one(client, tmp_path):
    muscle = bulge.Muscle(kind="braided", length="250 mm", radius="10 mm", braid_angle="25 deg", ends="cylinder")
    for name, hidden in [("friction", {"coulomb-friction": "20 N"}), ("nothing", {})]:
        bulge.simulate(muscle, PROTOCOL, hidden, seed=3).write(tmp_path / "cases" / name)
    (tmp_path / "cases" / "broken").mkdir()
    (tmp_path / "cases" / "broken" / "data.csv").write_text("pressure [bar],contraction [%]\n1,2\n")
    (tmp_path / "cases" / "broken" / "muscle.toml").write_text(muscle.to_toml())
    found = bulge.distributed.suite(tmp_path / "cases", tmp_path / "answers", client)
    assert (found.cases, found.answered, list(found.failed)) == (3, 2, ["broken"])
    assert "force" in found.failed["broken"]
    answers = {name: json.loads((tmp_path / "answers" / f"{name}.json").read_text()) for name in ("friction", "nothing")}
    assert [missing["effect"] for missing in answers["friction"]["missing"]] == ["coulomb-friction"]
    assert answers["nothing"]["verdict"] == "adequate"
    # The muscle that a simulation writes has the noise of the bench.
    case = tmp_path / "cases" / "friction"
    alone = bulge.diagnose(case / "data.csv", bulge.Muscle.from_toml(case / "muscle.toml"))
    assert alone.to_dict() == answers["friction"]
    assert bulge.distributed.suite(tmp_path / "cases", tmp_path / "answers", client).answered == 0


def test_diagnoses_come_in_the_order_of_the_cases(client):
    muscle = bulge.Muscle(kind="braided", length="250 mm", radius="10 mm", braid_angle="25 deg", ends="cylinder")
    hidden = [{"coulomb-friction": "20 N"}, {}]
    cases = [{"data": bulge.simulate(muscle, PROTOCOL, effects, seed=3).data, "muscle": muscle} for effects in hidden]
    found = bulge.distributed.diagnose_all(cases, client)
    assert [diagnosis.verdict for diagnosis in found] == ["missing", "adequate"]
    assert "coulomb-friction" in repr(found[0])
    with pytest.raises(bulge.InputError, match="left its report behind"):
        found[0].to_html()
    with pytest.raises(bulge.InputError, match="no effect"):
        bulge.distributed.diagnose_all([{**cases[0], "with_": ["frition"]}], client)


def test_mistakes(client, tmp_path):
    with pytest.raises(bulge.InputError, match="chunks_per_task"):
        bulge.distributed.sweep(_plan(), tmp_path / "sweep", client, chunks_per_task=0)
    with pytest.raises(bulge.InputError, match="holds no folder"):
        bulge.distributed.suite(tmp_path, tmp_path / "answers", client)
