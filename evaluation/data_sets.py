"""The data sets of an experiment by name, and where fits are. Imports nothing: the plan of a study reads it too."""

FIT_PATH = "fits/{experiment}/{variant}/{method}/{sampler}/D{D}/ROW{ROW}/seed{seed}.npz"
"""Where a fit is, below the output folder; `experiment` is the name of a data set."""


def data_set_name(experiment: str, dataset: int) -> str:
    """What files and draws call a data set of an experiment: the first has the experiment's own name.

    So the first is the same whether there are more or not. No name of a config has a dot.

    Args:
        experiment: The experiment's name in the config.
        dataset: The number of the data set, from 1.
    """
    return experiment if dataset == 1 else f"{experiment}.set{dataset}"
