"""Where the errors of a machine show, and how surely: from error distributions to maps.

In: a machine (`twin`), what is expected of its errors (`Population`), where it works (`Workspace`).
Out: a `Study`, or its pieces: Jacobians and sensitivities of every error parameter, shares of the
variance and the volumetric error without sampling (`first_order`), the volumetric error of random
machines with the standard error of every figure (`montecarlo`), total effects and regions
(`shares`), trajectories and volumes (`study`).

    population = Population(chain)
    study = run_study(population, Workspace(chain), 2000, 10_000, np.random.default_rng(1))
    study.ranking()                                    # [("EBZ", 0.13), ...]

Everything is in mm and rad; nothing here knows of standards or measurements. A distribution or a
dependence of errors goes into `population`, a figure of random machines into `montecarlo.tally`, a
way to name parts of a workspace into `shares`.
"""

PARTS = ("population", "first_order", "montecarlo", "shares", "study")
"""From bottom to top: each imports only from those before it."""
