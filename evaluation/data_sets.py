"""The data sets of an experiment by name. Imports nothing, because the plan of a study reads it too."""


def data_set_name(experiment: str, dataset: int) -> str:
    """What files and draws call a data set of an experiment: the first has the experiment's own name.

    So the first is the same whether there are more or not. No name of a config has a dot.

    Args:
        experiment: The experiment's name in the config.
        dataset: The number of the data set, from 1.
    """
    return experiment if dataset == 1 else f"{experiment}.set{dataset}"
