//! The classical Runge-Kutta method of order four.

/// The state after `step_s`; `derivative` takes the share of the step that has passed and the state there.
///
/// # Source
/// Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I, section II.1: order 4 where the derivative is
/// smooth over the step; a limit that begins or ends to bind inside a step costs order in that step.
pub(super) fn rk4<const N: usize>(
    state: [f64; N],
    step_s: f64,
    derivative: impl Fn(f64, &[f64; N]) -> [f64; N],
) -> [f64; N] {
    let moved = |slope: &[f64; N], share: f64| -> [f64; N] {
        std::array::from_fn(|i| state[i] + share * step_s * slope[i])
    };
    let k1 = derivative(0.0, &state);
    let k2 = derivative(0.5, &moved(&k1, 0.5));
    let k3 = derivative(0.5, &moved(&k2, 0.5));
    let k4 = derivative(1.0, &moved(&k3, 1.0));
    std::array::from_fn(|i| state[i] + step_s / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halving_the_step_divides_the_error_by_sixteen() {
        // A pendulum, far out: no closed form in elementary functions, so errors are against a step of 1/4096 s.
        let run = |steps: u32| {
            let mut state = [2.0, 0.0];
            for _ in 0..steps {
                state = rk4(state, 4.0 / f64::from(steps), |_, s| [s[1], -s[0].sin()]);
            }
            state[0]
        };
        let exact = run(16_384);
        let order = ((run(256) - exact) / (run(512) - exact)).abs().log2();
        assert!((order - 4.0).abs() < 0.2, "{order}");
    }
}
