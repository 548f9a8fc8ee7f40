"""Models and their runs go to other processes and come back as what they were."""

import copy
import pickle
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest

import symofros as sf
from tests.models import model as compiled


def mass_matrix(model: sf.Model) -> np.ndarray:
    return model.mass_matrix([0.1, 0.2])


@pytest.fixture(scope="module")
def arm() -> sf.Model:
    return compiled("cart_pole", "c")


def test_a_model_comes_back_with_its_parameters_and_settings(arm: sf.Model) -> None:
    changed = arm.with_parameters(m_cart=7.0).with_threads(2).with_precision("single")
    back = pickle.loads(pickle.dumps(changed))
    assert back.parameters == changed.parameters and (back.threads, back.precision) == (2, "single")
    assert np.array_equal(mass_matrix(back), mass_matrix(changed))
    unchecked = pickle.loads(pickle.dumps(arm.with_parameter_checks(False)))
    assert unchecked.with_parameters(m_cart=-1.0).parameters["m_cart"] == -1.0
    with pytest.raises(sf.ParameterError):
        back.with_parameters(m_cart=-1.0)


def test_a_model_works_in_another_process(arm: sf.Model) -> None:
    heavier = arm.with_parameters(m_cart=7.0)
    with ProcessPoolExecutor(1, get_context("spawn")) as pool:
        assert np.array_equal(pool.submit(mass_matrix, heavier).result(), mass_matrix(heavier))


def test_copies_share_the_code(arm: sf.Model) -> None:
    for other in (copy.copy(arm), copy.deepcopy(arm), copy.deepcopy({"model": arm})["model"]):
        assert np.array_equal(mass_matrix(other), mass_matrix(arm)) and other.parameters == arm.parameters


def test_runs_and_batches_come_back_whole(arm: sf.Model) -> None:
    run = sf.simulate(arm, [0.0, 0.2], t_end=0.05, dt=1e-2, events={"top": sf.Event("x")})
    for back in (pickle.loads(pickle.dumps(run)), copy.deepcopy(run)):
        assert np.array_equal(back.q, run.q) and back.outcome == run.outcome and np.array_equal(back.energy, run.energy)
    batch = sf.simulate_batch(arm, [[0.0, 0.2], [0.0, 0.3]], t_end=0.05, dt=1e-2)
    assert np.array_equal(pickle.loads(pickle.dumps(batch))[1].q, batch[1].q)
