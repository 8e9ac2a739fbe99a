"""Jobs shared out among threads."""

import pytest

from satAOI_geo.errors import InputError
from satAOI_geo.threads import run_threads


def test_threads_do_every_job_once_and_tell_how_far_they_are() -> None:
    shares: list[float] = []
    assert run_threads(lambda job: job**2, 50, shares.append) == [job**2 for job in range(50)]
    assert shares == [k / 50 for k in range(1, 51)]


def test_error_in_a_thread_is_raised_to_the_caller() -> None:
    def refuse(job: int) -> None:
        if job == 7:
            raise InputError("job 7")

    with pytest.raises(InputError, match="job 7"):
        run_threads(refuse, 20)
