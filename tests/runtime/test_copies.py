"""Models and their runs go to other processes and come back as what they were."""

import copy
import pickle
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest

import symofros as sf
from tests.models import model as compiled
from tests.models import system


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


def test_an_interpreted_model_is_interpreted_there() -> None:
    model = compiled("cart_pole")
    assert np.array_equal(mass_matrix(pickle.loads(pickle.dumps(model))), mass_matrix(model))


def test_runs_and_batches_come_back_whole(arm: sf.Model) -> None:
    run = sf.simulate(arm, [0.0, 0.2], t_end=0.05, dt=1e-2, events={"top": sf.Event("x")})
    for back in (pickle.loads(pickle.dumps(run)), copy.deepcopy(run)):
        assert np.array_equal(back.q, run.q) and back.outcome == run.outcome and np.array_equal(back.energy, run.energy)
    batch = sf.simulate_batch(arm, [[0.0, 0.2], [0.0, 0.3]], t_end=0.05, dt=1e-2)
    assert np.array_equal(pickle.loads(pickle.dumps(batch))[1].q, batch[1].q)


def test_a_run_is_shown_in_a_line_and_in_notebooks(arm: sf.Model) -> None:
    run = sf.simulate(arm, [0.0, 0.2], t_end=0.5, dt=1e-3)
    assert len(repr(run)) < 200 and "501 records" in repr(run) and "finished" in repr(run)
    assert run._repr_html_().count("<tr>") == 1 + len(run.columns())
    batch = sf.simulate_batch(arm, [[0.0, 0.2], [0.0, 0.3]], t_end=0.05, dt=1e-2)
    assert "2 finished" in repr(batch) and len(repr(batch)) < 200
    assert "m_cart = " in arm._repr_html_()


def test_a_column_that_is_not_there_is_refused_with_the_nearest(arm: sf.Model) -> None:
    run = sf.simulate(arm, [0.0, 0.2], t_end=0.01, dt=1e-2)
    with pytest.raises(sf.UnknownNameError, match="did you mean"):
        run["xx"]
    with pytest.raises(KeyError):
        run["nothing"]


def test_a_file_name_is_not_compiled(arm: sf.Model) -> None:
    with pytest.raises(sf.DescriptionError, match=r"sf\.compile\(sf\.load\('cart_pole\.yaml'\)\)"):
        sf.compile("cart_pole.yaml")
    with pytest.raises(sf.DescriptionError, match="a system is a sf.System"):
        sf.compile(system)
