"""Thresholds of the diagnosis, and the false-alarm rate of a run that follows from them."""

from dataclasses import asdict, dataclass

KINDS_OF_ALARM = 3
"""Kinds of tests that can each raise a false alarm: effects, patterns, lack of fit to repeats."""


@dataclass(frozen=True, slots=True)
class Policy:
    """What decides, in the order in which it is asked."""

    # probability that noise is taken for a gross error, a pattern, a region or an effect: of each
    # kind of test, all its trials together. One run in a thousand is what a user accepts who runs
    # one a week
    false_alarm: float = 1e-3
    # least gain of log evidence of an effect: odds of twenty to one, which pay for what the prior
    # of its size leaves open
    log_evidence_gain: float = 3.0
    # least effective number of touches that an effect explains, ``(sum d^2)^2 / sum d^4`` of what
    # it changes; a single one may be an accident. Without this test a slip of one touch was named
    # beside an effect of ten times its usual size
    touches_explained: float = 1.5
    # least coefficient of expansion that a found effect may have, 1/K: a control that corrects for
    # steel where nothing expands shows -12
    expansion_least: float = -15e-6
    # uncertainties by which a coefficient must lie below that to be refused: more happens to one
    # true expansion at the limit in a thousand
    impossible_ratio: float = 3.0
    # share of the squared residual that a pattern must hold. In ten thousand rows less is beyond
    # chance too, but would improve a prediction by half a per cent at most
    material_share: float = 0.01
    # error of held-out blocks with the richer of two explanations over that with the simpler, below
    # which it replaces it. Blocks are few, and 3 % are within their scatter
    error_share: float = 0.97
    # the same where the simpler one was found in sight of the rows left out: of a warm standard
    # without its sensor a field of all others predicted blocks of that day with 86 % of the error
    # of a smooth course in time, and another day worse than nothing
    error_share_in_sight: float = 0.85
    # log odds before any measurement that what a run follows was not recorded, against any one
    # recorded driver with any lag; the grid comes on top
    log_odds_unrecorded: float = 1.5
    # log odds against a driver that was not recorded below which a law is not named where the run
    # does not show which of several sensors it follows: of runs without the responsible sensor two
    # had 7.5 and 9.4, of those with it one had 11.2
    log_odds_open_driver: float = 10.0
    # log odds before any measurement against a series over a turn (harmonics, products of them),
    # for a law of weights and warmth that it can imitate: 20 to 1, as for any gain of evidence. A
    # series goes on with another payload as if nothing had changed
    log_odds_series: float = 3.0
    # log odds below which two explanations are not distinguished: 100 to 1
    log_odds_alike: float = 4.605170185988092  # log 100
    # log odds by which a rival on a coarse grid is behind beyond what a finer one could mend
    log_odds_ruled_out: float = 15.0
    # log odds in favour of a sensor that bears the letter of the axis on which it acts, for ties
    log_odds_own_sensor: float = 2.0
    # standard uncertainties by which a location error may be less clear than another single change
    # and is named all the same: odds of the root of e
    location_lead: float = 1.0
    # standard uncertainties from which a size is significant (GUM, k = 2)
    significant_ratio: float = 2.0
    # size of an effect over the stated noise below which no headline names it: a tenth of the noise
    # is not worth a compensation
    headline_noise_share: float = 0.1
    # probability by chance from which a member of a set that was chosen by prediction falls, if its
    # size does not speak for it: its company was judged as a whole
    chance_of_member: float = 0.05
    # probability by chance below which an effect stands although none of its numbers is significant
    certain_p: float = 1e-12
    # the same of an effect with more than two numbers (six of a slip that three touches saw, the
    # form of a face), that of a jump in a run without times, and that below which the effect
    # nearest to a remainder is named however little it leaves better
    close_p: float = 1e-6
    # noise over the stated one that is not believed unless repeats show it. Statements are wrong by
    # a factor of two, not more, on public records of known noise
    credible_noise: float = 2.5
    repeat_dof: int = 5  # degrees of freedom of repeated touches that show the noise within a third
    # residual over the scatter of repeated touches up to which they account for it: what a set-up
    # and an hour add to the scatter of touches made one after the other
    repeat_ratio: float = 1.5
    # noise over the stated one from which further periods are looked for
    noise_ratio_open: float = 1.5
    # residual over stated noise below which a pattern is within what was stated. Scatter of a
    # hundred touches does not reach so low
    noise_ratio_covered: float = 0.7
    # gain of log likelihood by which noise with memory must beat white noise: a chance of 6e-5,
    # since twice the gain is chi-squared with one degree of freedom
    memory_gain: float = 8.0
    # independent observations that a run must hold for its memory to be known: its length is
    # uncertain by about the root of two over their number, 37 % here
    memory_independent: float = 15.0
    # touches for one independent observation from which a residual is no longer nearly white
    memory_touches: float = 4.0
    # noise over the stated one above which a wandering residual is no noise
    memory_noise: float = 3.0
    # the same if no effect is beside it: users misjudge their noise by less, and an error that
    # follows the order of probing looks the same
    memory_noise_alone: float = 2.0
    # noise with memory over the stated one from which it may have a cause
    memory_loud_noise: float = 1.3
    # probability by chance below which a pattern is reported beside noise with memory, since a
    # residual of real parts never follows a memory exactly
    p_beside_memory: float = 1e-4
    # share of the squared residual that a jump in a run without times must hold: half of the
    # standard deviation or so
    jump_share: float = 0.2
    # standard deviations of the statistic of each test above its threshold at the size that is
    # called detectable, 91 %: an effect is found only if it exceeds chance and is ahead of its
    # rivals and of drivers that were not recorded, which all happens in four of five exactly
    # simulated runs (at 1.05 in 71 % of 52)
    detection_power: float = 1.35
    # standard uncertainties from which an excess over the expectation is not due to chance
    clear_excess: float = 3.0
    # a change counts as real from this many standard uncertainties. Some fifty quantities are
    # compared; chance makes one of them exceed this in one of three hundred such tables, and would
    # in one of eight at 3
    clear_change: float = 4.0
    # expected over remaining standard deviation from which a quantity is a result. With less the
    # expectation contributes more than a tenth, ``1 / 3^2``, to the estimate
    determined_ratio: float = 3.0
    # own standard uncertainties, and usual sizes of a location error, from which the line of a
    # rotary axis is far from where the machine file has it: of 64 lines of machines of the class
    # that were simulated the farthest was 1.7 usual sizes away. Beyond as many a number of the
    # description is wrong; a smaller one is an error of the machine or of the probe, and found as
    # such
    far_line: float = 5.0
    # of what all ordinary errors add up to at a line, below which it is not far either. Each error
    # is counted with all of its forms at full size, while a machine has about one: 1.5 are 2.6
    # standard deviations of that
    beyond_added_up: float = 1.5
    # log odds against a right description from which a mistake is named: five standard deviations
    # of a number beside what its freedom costs
    log_odds_mistake: float = 15.0
    # factor by which undoing a mistake must bring down the held-out error or the excess of the
    # machine's errors over what is expected
    mistake_improvement: float = 2.0
    # noise over the stated one, or errors over expected ones, from which axes are suspected
    mistake_suspected: float = 3.0
    # standard deviations between stated and found noise from which the statement is called wrong
    noise_misstated: float = 1.96
    # share of touches up to which an outlier is an accident by itself; more must look like
    # accidents
    accident_share: float = 0.05
    # largest share of touches that may be gross errors, since the median must stay free of them
    gross_share: float = 0.2
    # coefficient of variation from which sizes, or gaps, are those of accidents: one shift of many
    # touches, or of every tenth, has a cause. Sizes beyond a limit have 0.4 and more, gaps nearly 1
    accident_variation: float = 0.2
    # median of the scores of many accidents over the limit; a tail of wide noise has 1.1 to 1.2
    accident_score: float = 1.25
    # probability of so many neighbours among accidents, below which they are a crowd
    accident_neighbours: float = 1e-2
    # mean squared parameter over its prior variance from which the machine is called worse than its
    # stated distributions, and the prior is widened
    prior_exceeded: float = 2.0
    # log evidence that one error must gain to keep the size of its class. Some of seventy errors
    # gain less by chance and would absorb a weak effect
    log_evidence_released: float = 1.0
    # most parameters of an effect, a sine and a cosine, whose size tests the effect. The size of
    # more parameters may be uncertain although the effect is not: the form of a face of 1.9 µm with
    # a chance of 1e-8 is reported as 3.0 ± 1.6 µm
    sized_parameters: int = 2

    @property
    def false_alarm_of_run(self) -> float:
        """Most probable share of runs with nothing hidden that say otherwise."""
        return KINDS_OF_ALARM * self.false_alarm

    def table(self) -> dict[str, float]:
        """Every threshold by name, and what follows for a run."""
        return {**asdict(self), "false_alarm_of_run": self.false_alarm_of_run}


POLICY = Policy()
"""By which every diagnosis decides."""
